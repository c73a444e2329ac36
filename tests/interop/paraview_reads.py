"""pvpython: the .pvd and the .xmf files have the run's times, pieces and positions."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import tables
from paraview.simple import OpenDataFile
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

folder = os.path.abspath(sys.argv[1])
judge = tables.frames(folder)
family = tables.genealogy(folder)
times = sorted(judge)
NEAR = 1e-6  # m: floats of numbers up to 1


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
for time in (times[0], times[len(times) // 2], times[-1]):
    pieces = judge[time]
    tets, triangles = at(collection, time)
    for grid, name in ((tets, "run.pvd"), (at(mesh, time)[0], "run_mesh.xmf")):
        piece = vtk_to_numpy(grid.GetCellData().GetArray("piece" if name == "run.pvd" else "fragment"))
        check(set(piece) == set(pieces), f"{name} has the pieces {set(piece)} at {time}")
        for i in pieces:
            check(sum(piece == i) == int(family[i]["tets"]), f"{name} has {sum(piece == i)} tets in piece {i} at {time}")
    stress = vtk_to_numpy(tets.GetCellData().GetArray("stress"))
    check(abs(stress).max() < 1e9 and abs(stress).max() > 1 or time == times[0], "run.pvd has no stress")
    damage = vtk_to_numpy(tets.GetCellData().GetArray("damage"))
    check(0 <= damage.min() and damage.max() <= 1, "run.pvd has wrong damage")
    cloud = at(points, time)[0]
    ids = vtk_to_numpy(cloud.GetPointData().GetArray("fragment"))
    where = vtk_to_numpy(cloud.GetPoints().GetData())
    check(len(ids) == len(pieces), f"run_fragments.xmf has {len(ids)} pieces")
    for i, place in zip(ids, where):
        check(max(abs(a - b) for a, b in zip(place, pieces[i][0])) < NEAR, f"piece {i} is at {place}")
    box = at(obstacles, time)[0]
    kinds = vtk_to_numpy(box.GetCellData().GetArray("obstacle"))
    check(set(kinds) == {0, 1, 2}, f"run_obstacles.xmf has the obstacles {set(kinds)}")
    check(triangles.GetNumberOfCells() == len(kinds), "run.pvd has other obstacles")
print(f"as in the run file: {len(times)} times, {len(judge[times[-1]])} pieces, 3 obstacles in 4 files")
