"""Python's own csv module, and the words of the .obj: every number of the run file, digit by digit."""
import collections
import csv
import sys

import tables

folder = sys.argv[1]
judge = tables.Judge(folder)


def rows(name):
    with open(f"{folder}/run_{name}.csv", newline="") as stream:
        return list(csv.DictReader(stream))


def numbers(row, *columns):
    return [float(row[column]) for column in columns]


def check(condition, message):
    if not condition:
        sys.exit(f"CSV: {message}")


PLACE, TURN = [f"P.{k} [m]" for k in "xyz"], [f"orient.{k}" for k in "wxyz"]
seen = [{} for _ in judge.times]
for row in rows("trajectories"):
    seen[judge.times.index(float(row["time [s]"]))][int(row["fragment"])] = [numbers(row, *PLACE), numbers(row, *TURN)]
check(seen == judge.pieces, "_trajectories has other places, turns, times or pieces")
for row in rows("genealogy"):
    fragment = judge.fragments[int(row["id"])]
    for key, column in (("parent", "parent"), ("line", "line"), ("tets", "tets"), ("mass", "mass [kg]"), ("birth", "birth [s]")):
        check(float(row[column] or -1) == fragment[key], f"piece {row['id']} has the {key} {row[column]}, not {fragment[key]}")
    check(numbers(row, *(f"pivot.{k} [m]" for k in "xyz")) == fragment["pivot"], f"piece {row['id']} has another pivot")
names, found = [o["name"] for o in judge.obstacles], [{} for _ in judge.times]
for row in rows("obstacles"):
    found[judge.times.index(float(row["time [s]"]))][names.index(row["name"])] = [numbers(row, *PLACE), numbers(row, *TURN)]
check(found == judge.obstacle_poses, "_obstacles has other places or turns")
shapes, triangles, places = {}, {}, [None]
corners, faces = None, None
with open(f"{folder}/run_pieces.obj") as stream:
    for line in stream:
        word, *rest = line.split()
        if word == "o":
            corners, faces = shapes.setdefault(rest[0], []), triangles.setdefault(rest[0], [])
        elif word == "v":
            corners.append([float(x) for x in rest])
            places.append(corners[-1])
        elif word == "f":
            faces.append([int(i) for i in rest])
check(set(shapes) == set(judge.shapes), "_pieces.obj has other lines")
for name, corners in shapes.items():
    of_tets = {tuple(round(1e7 * x) for x in corner) for corner in judge.shapes[name]}
    check({tuple(round(1e7 * x) for x in corner) for corner in corners} <= of_tets, f"{name} has corners that no tet of it has")
    check(tables.apart(tables.reach(corners), tables.reach(judge.shapes[name])) < 1e-8, f"{name} has another size")
    directed, volume = collections.Counter(), 0.0
    for face in triangles[name]:
        directed.update(zip(face, face[1:] + face[:1]))
        volume += tables.box(*(places[i] for i in face)) / 6.0
    check(all(directed[edge] == directed[edge[::-1]] for edge in directed), f"{name} is not closed")
    wanted = judge.fragments[judge.leaves[name]]["volume"]
    check(abs(volume - wanted) < 1e-6 * wanted, f"{name} surrounds {volume} m3, not {wanted}")
print(f"as in the run file: {len(judge.times)} frames, {len(judge.fragments)} pieces, {len(names)} obstacles, {len(shapes)} shapes")
