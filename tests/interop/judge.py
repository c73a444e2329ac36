"""Reads a run file with h5py, as docs/run_file.md tells, and leaves what the other programs' readings are compared with in judge.json."""
import json
import sys

import h5py

folder = sys.argv[1]
run = h5py.File(f"{folder}/run.h5")
kinds = {dtype: {number: name for name, number in h5py.check_enum_dtype(run["/obstacles/list"].dtype[dtype]).items()} for dtype in ("shape", "motion")}


def bodies(group, frame, there):
    """Of a frame: number of a body to its position and orientation."""
    place, turn = run[f"{group}/position"][frame], run[f"{group}/orientation"][frame]
    return {int(i): [place[i].tolist(), turn[i].tolist()] for i in there}


times = run["/trajectory/time"][:]
table, lineage = run["/fragments/list"][:], run["/fragments/lineage"][:]
alive, obstacles = run["/trajectory/alive"][:], run["/obstacles/list"][:]
nodes, elements, last = run["/mesh/positions"][:], run["/mesh/elements"][:], run["/fragments/elements"][:]
shapes = {}
for i in set(last.tolist()):
    shapes[f"line_{lineage[i]}"] = (nodes[elements[last == i].ravel()] - table["reference_centre"][i]).tolist()
with open(f"{folder}/judge.json", "w") as stream:
    json.dump({
        "times": times.tolist(),
        "pieces": [bodies("/trajectory", f, alive[f].nonzero()[0]) for f in range(len(times))],
        "fragments": [{"parent": int(row["parent"]), "line": int(lineage[i]), "tets": int(row["tets"]), "mass": float(row["mass"]), "volume": float(row["volume"]),
                       "birth": float(row["birth"]), "pivot": row["reference_centre"].tolist()} for i, row in enumerate(table)],
        "shapes": shapes,
        "obstacles": [{"name": run["/obstacles/name"].asstr()[i], "shape": kinds["shape"][row["shape"]], "radius": float(row["radius"]),
                       "size": row["size"].tolist()} for i, row in enumerate(obstacles)],
        "obstacle_poses": [bodies("/obstacles", f, range(len(obstacles))) for f in range(len(times))],
        # Of the frames that are looked at corner by corner.
        "corners": {str(f): run["/nodes/corners"][f].tolist() for f in (0, len(times) // 2, len(times) - 1)},
        "holders": {str(f): run["/nodes/fragment"][f].tolist() for f in (0, len(times) // 2, len(times) - 1)},
    }, stream)
