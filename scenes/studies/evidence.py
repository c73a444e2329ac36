#!/usr/bin/env python3
"""Does an impact converge over the mesh, and which settings are right for what? Makes the tables of docs/evidence.md.
usage: scenes/studies/evidence.py PROGRAM FOLDER [PART …]
A PART is the start of names of runs, such as convergence/12, tile or "why*/12"; none: tables only of what FOLDER has. It keeps one JSON a run,
so that nothing is run twice. h5py and numpy read the run files."""
import fnmatch, itertools, json, math, os, subprocess, sys
import h5py
import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SEEDS = range(1, 9)
FAR = 0.03  # m from the point of contact
SHELL, SHELLS = 0.01, 15  # m; of facets by their distance from the point of contact
LIMIT = 1200  # s of processor time a run may take

# ---- what is run ----

BALL = dict(scene="concrete_ball", material="concrete", edge="objects.ball.mesh.ball.edge", set={"duration": 5e-4})
# The tile of tile_on_floor.yaml half a millimetre above the floor, as if it fell from 1 m, with `keep`, which other words stand beside; the mug
# likewise, with the word that it has, and filled anew.
TILE = dict(scene="hybrid/tile_on_floor", material="plaster", edge="objects.tile.mesh.box.edge",
            set={"duration": 3e-3, "objects.tile.position": "[0, 0, 0.0357]", "objects.tile.velocity": "[0, 0, -4.43]",
                 "materials.plaster.unresolved": "keep"})
MUG = dict(scene="mug/mug", material="stoneware", edge="objects.mug.mesh",
           set={"duration": 6e-4, "objects.mug.position": "[0, 0, 0.0363]", "objects.mug.velocity": "[0, 0, -4.45]"})
BODIES = {"ball": BALL, "tile": TILE, "mug": MUG}


def turned(corners, edge, seed):
    """A mesh in no order of what a profile sweeps."""
    profile = ", ".join(f"{{radius: {r:.9f}, height: {z:.9f}}}" for r, z in corners)
    return f"{{turned: {{profile: [{profile}], edge: {edge:g}}}, seed: {seed}}}"


CUP = ((0, 0), (0.04, 0), (0.04, 0.09), (0.036, 0.09), (0.036, 0.005), (0, 0.005))
HALF_CIRCLE = [(0.075 * abs(math.sin(a)), -0.075 * math.cos(a)) for a in np.linspace(0, math.pi, 25)]

# What else was tried on the ball, to find what a miss comes from.
WHY = {
    "in no order, another mesh for each seed": {"objects.ball.mesh": lambda edge, seed: turned(HALF_CIRCLE, edge, seed)},
    "turned, another way for each seed": {"objects.ball.rotation": lambda edge, seed: f"{{axis: [1, {seed}, 3], angle: {40 * seed}}}"},
    "friction_angle: 37": {"materials.concrete.friction_angle": 37},
}


def settings(body):
    """name: settings, of one body; the first is the scene as it is."""
    word = f"materials.{BODIES[body]['material']}.unresolved"
    keep = {word: "keep"}  # only `force` knows tip_strength
    found = {
        "as it is": {},
        "criterion: traction": {"fracture.criterion": "traction", **keep},
        "criterion: traction, threshold: 0.9": {"fracture.criterion": "traction", "fracture.threshold": 0.9, **keep},
        "criterion: principal": {"fracture.criterion": "principal", **keep},
        "threshold: 0.9": {"fracture.threshold": 0.9},
        "check_every: 1": {"fracture.check_every": 1},
        "check_every: 10": {"fracture.check_every": 10},
    }
    if body != "mug":
        found |= {f"jitter: {j}": {f"objects.{body}.mesh.jitter": j} for j in (0, 0.3)}
    if body == "tile":
        found |= {f"pattern: {p}": {"objects.tile.mesh.box.pattern": p} for p in ("bricks", "unstructured")}
    if body != "ball":  # its cohesive zone is resolved, so that the word changes nothing
        own = "tip_strength" if body == "mug" else "keep"
        found |= {f"unresolved: {u}": {word: u} for u in ("keep", "tip_strength", "scale_strength", "scale_energy") if u != own}
    return found


def runs():
    """name of a run, body, settings"""
    for edge, seed in itertools.product((18, 12, 8), SEEDS):
        yield f"convergence/{edge} mm/{seed}", BALL, {BALL["edge"]: edge * 1e-3, "seed": seed}
    for edge, seed in itertools.product((15, 10), SEEDS[:4]):
        yield f"edges/{edge} mm/{seed}", BALL, {BALL["edge"]: edge * 1e-3, "seed": seed}
    for (name, values), edge, seed in itertools.product(WHY.items(), (18, 15, 12, 8), SEEDS[:4]):
        values = {key: value(edge * 1e-3, seed) if callable(value) else value for key, value in values.items()}
        size = {} if "objects.ball.mesh" in values else {BALL["edge"]: edge * 1e-3}
        yield f"why {name}/{edge} mm/{seed}", BALL, {**size, **values, "seed": seed}
    for body, edges in (("tile", (12, 8, 6)), ("ball", (18, 12)), ("mug", (4, 3))):
        for edge, (name, values), seed in itertools.product(edges, settings(body).items(), SEEDS[:2]):
            size = turned(CUP, edge * 1e-3, 1) if body == "mug" else edge * 1e-3
            yield f"{body}/{edge} mm/{name}/{seed}", BODIES[body], {BODIES[body]["edge"]: size, **values, "seed": seed}


# ---- what is measured ----

def facets(run):
    """Of the facets between tets at the last frame: centre and area in the reference mesh, whether it bonds, damage."""
    x, tets = run["/mesh/positions"][:], run["/mesh/elements"][:]
    nodes = np.sort(np.stack([np.delete(tets, i, axis=1) for i in range(4)], axis=1).reshape(-1, 3), axis=1)
    _, first, count = np.unique(nodes, axis=0, return_index=True, return_counts=True)
    inside = first[count == 2]
    a, b, c = (x[nodes[inside, i]] for i in range(3))
    bond, damage = (run["/nodes/" + name][-1].ravel()[inside] for name in ("bond", "damage"))
    return (a + b + c) / 3, 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1), bond != 0, damage


def measure(path, said):
    """What the tables show of one run; `said` is what `run --json` printed. Energy by damage is damage × area × G: what a facet took
    where G is the same in opening and in shear, as in the ball."""
    with h5py.File(path) as run:
        x, tets, piece = run["/mesh/positions"][:], run["/mesh/elements"][:], run["/nodes/fragment"][-1]
        place, area, bonds, damage = facets(run)
        energy = damage * area * run["/materials/fracture_energy"][0]
    corners, contact = x[tets], x[np.argmin(x[:, 2])]
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    _, index, count = np.unique(piece, return_inverse=True, return_counts=True)
    of_pieces = lambda what: np.bincount(index, volume * what)
    share = of_pieces(1) / volume.sum()
    centre = np.stack([of_pieces(corners.mean(axis=1)[:, i]) for i in range(3)], axis=1) / of_pieces(1)[:, None]
    far, single = np.linalg.norm(centre - contact, axis=1) > FAR, count == 1
    shell = np.minimum(np.linalg.norm(place - contact, axis=1) // SHELL, SHELLS - 1).astype(int)
    by_shell = lambda what: np.bincount(shell, what, SHELLS).tolist()
    return {"tets": len(tets), "pieces": len(count), "largest": float(share.max()), "single": int(single.sum()),
            "single_mass": float(share[single].sum()), "far_pieces": int(far.sum()), "far_single": int((far & single).sum()),
            "unopened": float(energy[bonds].sum()), "by_damage": float(energy.sum()),
            "shells": {"energy": by_shell(energy), "unopened": by_shell(energy * bonds)}, "said": said}


def make(program, folder, name, body, values):
    """Runs what is not there yet."""
    kept = os.path.join(folder, name.replace("/", "__").replace(" ", "_").replace(":", "") + ".json")
    if os.path.exists(kept):
        return
    file, told = kept[:-5] + ".h5", kept + ".part"
    command = ["prlimit", f"--cpu={LIMIT}", program, "run", os.path.join(ROOT, "scenes", body["scene"] + ".yaml"),
               "--force", "--json", "--checkpoint", "0", "--output", file]
    for key, value in {**body["set"], **values, "threads": 1, "output.nodes": "true"}.items():
        command += ["--set", f"{key}={value}"]
    print(name, file=sys.stderr, flush=True)
    with open(told, "w") as out, open(kept + ".log", "w") as log:
        child = subprocess.Popen(command, stdout=out, stderr=log)
        _, status, usage = os.wait4(child.pid, 0)
    result = {"name": name, "seconds": usage.ru_utime, "status": status}
    if status == 0:
        with open(told) as out:
            result |= measure(file, json.load(out))
    with open(told, "w") as out:
        json.dump(result, out)
    os.replace(told, kept)
    if os.path.exists(file):
        os.remove(file)


def read(folder):
    """What was measured: {name without its seed: runs}."""
    found = {}
    for file in sorted(os.listdir(folder)):
        if file.endswith(".json"):
            with open(os.path.join(folder, file)) as text:
                result = json.load(text)
            found.setdefault(result["name"].rsplit("/", 1)[0], []).append(result)
    return found


# ---- tables ----

def ledger(key, sign=1):
    return lambda r: sign * r["said"][key]


KINETIC, FRACTURE, LARGEST = ledger("kinetic"), ledger("fracture_dissipation"), lambda r: r["largest"]
KINETIC_SHARE = lambda r: 100 * r["said"]["kinetic"] / r["said"]["largest_energy"]
FAR_SINGLE, SINGLE_MASS = lambda r: 100 * r["far_single"] / max(r["far_pieces"], 1), lambda r: 100 * r["single_mass"]
UNOPENED, OPENED = lambda r: 100 * r["unopened"] / r["by_damage"], lambda r: r["by_damage"] - r["unopened"]
FRICTION = lambda r: -r["said"]["friction"] - r["said"]["crack_friction"]
PIECES = lambda r: r["pieces"]

QUANTITIES = [  # what, format, of a run
    ("kinetic energy, J", "%.1f", KINETIC),
    ("the same, % of that at the start", "%.1f", KINETIC_SHARE),
    ("fracture energy, J", "%.2f", FRACTURE),
    ("of that by damage: facets that have opened, J", "%.2f", OPENED),
    ("facets that have not, J", "%.2f", lambda r: r["unopened"]),
    ("facets that have not, %", "%.1f", UNOPENED),
    ("all by damage over that of the ledger", "%.3f", lambda r: r["by_damage"] / r["said"]["fracture_dissipation"]),
    ("largest piece's share", "%.3f", LARGEST),
    ("pieces", "%.0f", PIECES),
    ("pieces farther than 3 cm from the contact", "%.0f", lambda r: r["far_pieces"]),
    ("single tets among the latter, %", "%.2f", FAR_SINGLE),
    ("single tets, % of the mass in all", "%.3f", SINGLE_MASS),
    ("friction, J", "%.2f", FRICTION),
    ("taken by closing faces, J", "%.2f", ledger("closure", -1)),
    ("taken by contact with the floor, J", "%.2f", ledger("contact", -1)),
    ("area inserted, m²", "%.3f", ledger("inserted_area")),
    ("area failed, m²", "%.4f", ledger("failed_area")),
    ("largest stress at insertion / strength", "%.1f", ledger("worst_overshoot")),
    ("residual of the ledger / largest energy", "%.1e", lambda r: abs(r["said"]["residual"]) / r["said"]["largest_energy"]),
    ("processor time, s", "%.0f", lambda r: r["seconds"]),
]
SHOWN_WHY = [("kinetic energy, %", "%.1f", KINETIC_SHARE), ("fracture energy, J", "%.1f", FRACTURE), ("opened, J", "%.1f", OPENED),
             ("not opened, %", "%.1f", UNOPENED), ("largest share", "%.3f", LARGEST), ("pieces", "%.0f", PIECES),
             ("friction, J", "%.1f", FRICTION), ("area inserted, m²", "%.2f", ledger("inserted_area"))]
SHOWN_SETTINGS = [("largest share", "%.3f", LARGEST), ("pieces", "%.0f", PIECES),
                  ("single tets, % of pieces", "%.0f", lambda r: 100 * r["single"] / r["pieces"]), ("% of the mass", "%.2f", SINGLE_MASS),
                  ("fracture energy, J", "%.3g", FRACTURE), ("inserted", "%.0f", ledger("inserted")), ("failed", "%.0f", ledger("failed")),
                  ("stress at insertion", "%.1f", ledger("worst_overshoot")), ("time, s", "%.2g", lambda r: r["seconds"])]


def mean(runs, part):
    """Mean and its standard error."""
    values = [part(r) for r in runs]
    count, middle = len(values), sum(values) / len(values)
    return middle, math.sqrt(sum((v - middle) ** 2 for v in values) / (count - 1) / count) if count > 1 else math.nan


def cell(runs, form, part):
    middle, error = mean(runs, part)
    return form % middle + ("" if math.isnan(error) else " ± " + form % error)


def row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |")


def head(*cells):
    print()
    row(*cells)
    print("|---" * len(cells) + "|")


def convergence(found):
    groups = [found[f"convergence/{edge} mm"] for edge in (18, 12, 8)]
    head("edge", "18 mm", "12 mm", "8 mm")
    row("tets", *(f"{runs[0]['tets']:,}" for runs in groups))
    row("runs", *(len(runs) for runs in groups))
    for what, form, part in QUANTITIES:
        row(what, *(cell(runs, form, part) for runs in groups))
    head("target", "at most", "found", "")
    middle, finest = groups[1:]
    for what, part, bound in (("kinetic energy, 12 to 8 mm", KINETIC, 0.05), ("fracture energy, 12 to 8 mm", FRACTURE, 0.2)):
        (a, s), (b, t) = mean(middle, part), mean(finest, part)
        change = abs(b - a) / b
        row(what, f"{bound:.0%}", f"{change:.1%} ± {math.hypot(s / b, t * a / b**2):.1%}", "held" if change <= bound else "missed")
    (a, s), (b, t) = mean(middle, LARGEST), mean(finest, LARGEST)
    row("largest share, 12 to 8 mm", 0.1, f"{abs(b - a):.3f} ± {math.hypot(s, t):.3f}", "held" if abs(b - a) <= 0.1 else "missed")
    for what, part, bound in (("single tets, % of pieces away from the contact", FAR_SINGLE, 30), ("single tets, % of the mass", SINGLE_MASS, 2),
                              ("energy of facets that have not opened, %", UNOPENED, 30)):
        worst = max(groups, key=lambda runs: mean(runs, part)[0])
        row(what + ", on any mesh", bound, cell(worst, "%.2f", part), "held" if mean(worst, part)[0] <= bound else "missed")


def shells(found):
    """Fracture energy by distance from the contact, of facets that have opened and that have not."""
    bounds = list(itertools.pairwise((0, 3, 6, 9, SHELLS)))
    head("edge", *(f"{a} to {b} cm" for a, b in bounds))
    for edge in (18, 12, 8):
        part = lambda what, a, b: mean(found[f"convergence/{edge} mm"], lambda r: sum(r["shells"][what][a:b]))[0]
        row(f"{edge} mm", *(f"{part('energy', *b) - part('unopened', *b):.2f} + {part('unopened', *b):.2f}" for b in bounds))


def why(found):
    head("the ball", "edge, mm", "runs", *(what for what, *_ in SHOWN_WHY))
    for name, edge in itertools.product(("as it is", *WHY), (18, 15, 12, 10, 8)):
        runs = [r for title in ("convergence", "edges") for r in found.get(f"{title}/{edge} mm", [])] if name == "as it is" else \
            found.get(f"why {name}/{edge} mm")
        if runs:
            row(name, edge, len(runs), *(cell(runs, *how) for _, *how in SHOWN_WHY))


def compared(found, body):
    for edge in sorted({key.split("/")[1] for key in found if key.startswith(body + "/")}, key=lambda e: -float(e.split()[0])):
        head(f"{body}, {edge}", "runs", *(what for what, *_ in SHOWN_SETTINGS))
        for setting in settings(body):
            runs = found.get(f"{body}/{edge}/{setting}", [])
            good = [r for r in runs if r["status"] == 0]
            if good:
                row(setting, len(good), *(cell(good, *how) for _, *how in SHOWN_SETTINGS))
            if len(good) < len(runs):
                row(setting, f"{len(runs) - len(good)} did not end", *[""] * len(SHOWN_SETTINGS))


def main(program, folder, parts):
    os.makedirs(folder, exist_ok=True)
    for part in parts:
        for name, body, values in runs():
            if fnmatch.fnmatchcase(name, part + "*"):
                make(program, folder, name, body, values)
    found = read(folder)
    if all(f"convergence/{edge} mm" in found for edge in (18, 12, 8)):
        convergence(found)
        shells(found)
    why(found)
    for body in BODIES:
        compared(found, body)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
