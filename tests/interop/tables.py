"""The tables of a run, as the judges of what other programs read."""
import csv


def rows(folder, name):
    with open(f"{folder}/run_{name}.csv", newline="") as stream:
        return list(csv.DictReader(stream))


def frames(folder):
    """Times, and for each time the living fragments: id to (position, orientation w x y z)."""
    found = {}
    for row in rows(folder, "trajectories"):
        place = [float(row[f"P.{k} [m]"]) for k in "xyz"]
        turn = [float(row[f"orient.{k}"]) for k in "wxyz"]
        found.setdefault(float(row["time [s]"]), {})[int(row["fragment"])] = (place, turn)
    return found


def genealogy(folder):
    return {int(row["id"]): row for row in rows(folder, "genealogy")}


def shapes(folder):
    """Corners of every line about the centre of its last fragment."""
    found, corners = {}, None
    with open(f"{folder}/run_pieces.obj") as stream:
        for line in stream:
            word, *rest = line.split()
            if word == "o":
                corners = found[rest[0]] = []
            elif word == "v":
                corners.append([float(x) for x in rest])
    return found


def rotate(q, v):
    w, x, y, z = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0]]


def body(folder, pieces, leaf, family):
    """Where the centre of the fragment `leaf` is while `pieces` live: it moves with the ancestor that does."""
    ancestor = leaf
    while ancestor not in pieces:
        ancestor = int(family[ancestor]["parent"])
    pivot = [[float(family[i][f"pivot.{k} [m]"]) for k in "xyz"] for i in (leaf, ancestor)]
    place, turn = pieces[ancestor]
    arm = rotate(turn, [a - b for a, b in zip(*pivot)])
    return [p + a for p, a in zip(place, arm)], turn
