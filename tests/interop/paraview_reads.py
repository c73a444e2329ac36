"""pvpython: the .pvd and the .xmf files have the run's times, pieces and positions."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import tables
from paraview.simple import OpenDataFile
from paraview import servermanager
from vtkmodules.vtkFiltersCore import vtkConnectivityFilter
from vtkmodules.util.numpy_support import vtk_to_numpy

folder = os.path.abspath(sys.argv[1])
judge = tables.Judge(folder)
times = judge.times
NEAR = 1e-6  # m: floats of numbers up to 1
ROUND = 1e-4  # m: a ball of triangles is no ball


def blocks(data):
    if not data.IsA("vtkCompositeDataSet"):
        return [data]
    iterator = data.NewIterator()
    found = []
    while not iterator.IsDoneWithTraversal():
        found.append(iterator.GetCurrentDataObject())
        iterator.GoToNextItem()
    return found


def at(source, time):
    source.SMProxy.UpdatePipeline(time)  # that of paraview.simple takes time 0 for none
    return blocks(servermanager.Fetch(source))


def check(condition, message):
    if not condition:
        sys.exit(f"ParaView: {message}")


def check_times(source, name):
    seen = list(source.TimestepValues)
    check(len(seen) == len(times) and max(abs(a - b) for a, b in zip(seen, times)) < 1e-12, f"{name} has the times {seen}")


collection = OpenDataFile(f"{folder}/run.pvd")
mesh = OpenDataFile(f"{folder}/run_mesh.xmf")
points = OpenDataFile(f"{folder}/run_fragments.xmf")
obstacles = OpenDataFile(f"{folder}/run_obstacles.xmf")
for source, name in ((collection, "run.pvd"), (mesh, "run_mesh.xmf"), (points, "run_fragments.xmf"), (obstacles, "run_obstacles.xmf")):
    check_times(source, name)
def check_tets(grid, field, frame, name):
    """All tets, each with its fragment and the places of its corners; in the run file's order."""
    holders = vtk_to_numpy(grid.GetCellData().GetArray(field))
    check((holders == judge.holders[frame]).all(), f"{name} has tets in other pieces in frame {frame}")
    places, tets = vtk_to_numpy(grid.GetPoints().GetData()), vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
    far = abs(places[tets].reshape(-1, 12) - judge.corners[frame]).max()
    check(far < NEAR, f"{name} has corners that are {far} m off in frame {frame}")


def check_shared(grid, frame):
    """No point of two pieces; at the start every node once, and one body."""
    tets = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
    pairs = {(point, holder) for holder, tet in zip(judge.holders[frame], tets.tolist()) for point in tet}
    check(len(pairs) == grid.GetNumberOfPoints(), f"run.pvd has points of two pieces in frame {frame}")
    if frame > 0:
        return
    connectivity = vtkConnectivityFilter()
    connectivity.SetInputData(grid)
    connectivity.SetExtractionModeToAllRegions()
    connectivity.Update()
    regions, nodes = connectivity.GetNumberOfExtractedRegions(), len({tuple(tet[k : k + 3]) for tet in judge.corners[0] for k in (0, 3, 6, 9)})
    check(regions == 1 and grid.GetNumberOfPoints() == nodes, f"run.pvd begins as {regions} bodies of {grid.GetNumberOfPoints()} points, not {nodes}")


def check_obstacles(grid, frame, name):
    numbers = vtk_to_numpy(grid.GetCellData().GetArray("obstacle"))
    check(set(numbers) == set(range(len(judge.obstacles))), f"{name} has the obstacles {set(numbers)}")
    cells = grid.GetPolys() if grid.IsA("vtkPolyData") else grid.GetCells()
    places, triangles = vtk_to_numpy(grid.GetPoints().GetData()), vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, 3)
    for number in set(numbers):
        wanted = judge.obstacle_reach(number, frame)
        seen = tables.reach(places[triangles[numbers == number].ravel()].tolist())
        check(wanted is None or tables.apart(seen, wanted) < ROUND, f"{name}: obstacle {number} reaches to {seen}, not {wanted}, in frame {frame}")


for frame in judge.three:
    time, pieces = times[frame], judge.pieces[frame]
    tets, triangles = at(collection, time)
    check_tets(tets, "piece", frame, "run.pvd")
    check_shared(tets, frame)
    check_tets(at(mesh, time)[0], "fragment", frame, "run_mesh.xmf")
    stress = vtk_to_numpy(tets.GetCellData().GetArray("stress"))
    check(abs(stress).max() < 1e9 and abs(stress).max() > 1 or frame == 0, "run.pvd has no stress")
    damage = vtk_to_numpy(tets.GetCellData().GetArray("damage"))
    check(0 <= damage.min() and damage.max() <= 1, "run.pvd has wrong damage")
    cloud = at(points, time)[0]
    ids = vtk_to_numpy(cloud.GetPointData().GetArray("fragment"))
    turns = vtk_to_numpy(cloud.GetPointData().GetArray("orientation_wxyz"))
    check(sorted(ids) == sorted(pieces), f"run_fragments.xmf has {len(ids)} pieces")
    for i, place, turn in zip(ids, vtk_to_numpy(cloud.GetPoints().GetData()), turns):
        check(tables.apart(place, pieces[i][0]) < NEAR and tables.apart(turn, pieces[i][1]) < NEAR, f"piece {i} is at {place}, turned by {turn}")
    check_obstacles(triangles, frame, "run.pvd")
    check_obstacles(at(obstacles, time)[0], frame, "run_obstacles.xmf")
print(f"as in the run file: {len(times)} times, {len(judge.pieces[-1])} pieces, {len(judge.obstacles)} obstacles in 4 files")
