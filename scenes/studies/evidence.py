#!/usr/bin/env python3
"""Does an impact converge over the mesh, and which settings are right for what? Makes the tables of docs/evidence.md.
usage: scenes/studies/evidence.py PROGRAM FOLDER [PART …]; a PART is the start of names of runs, such as convergence/12, tile or "why*/12"; none: tables only.
FOLDER keeps one JSON a run, so that what is there is not run again; h5py and numpy read the run files."""
import fnmatch, itertools, json, math, os, subprocess, sys
import h5py
import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SEEDS = range(1, 9)
FAR = 0.03  # m from the point of contact
SHELL, SHELLS = 0.01, 15  # m; of facets by their distance from the point of contact
LIMIT = 1200  # s of processor time a run may take

BALL = dict(scene="concrete_ball", material="concrete", edge="objects.ball.mesh.ball.edge",
            set={"duration": 5e-4})
# The tile of tile_on_floor.yaml half a millimetre above the floor, as if it fell from 1 m; the mug likewise, and filled anew.
TILE = dict(scene="hybrid/tile_on_floor", material="plaster", edge="objects.tile.mesh.box.edge",
            set={"duration": 3e-3, "objects.tile.position": "[0, 0, 0.0357]", "objects.tile.velocity": "[0, 0, -4.43]"})
CUP = "{turned: {profile: [" + ", ".join(f"{{radius: {r}, height: {z}}}" for r, z in (
    (0, 0), (0.04, 0), (0.04, 0.09), (0.036, 0.09), (0.036, 0.005), (0, 0.005))) + "], edge: %g}, seed: 1}"
MUG = dict(scene="mug/mug", material="stoneware", edge="objects.mug.mesh",
           set={"duration": 1.5e-3, "objects.mug.position": "[0, 0, 0.0363]", "objects.mug.velocity": "[0, 0, -4.45]"})
BODIES = {"ball": BALL, "tile": TILE, "mug": MUG}


# What else was tried on the ball, to find what a miss comes from.
HALF_CIRCLE = [(0.075 * math.sin(math.radians(7.5 * i)), 0.075 * -math.cos(math.radians(7.5 * i))) for i in range(25)]
UNORDERED = "{turned: {profile: [" + ", ".join(f"{{radius: {abs(r):.9f}, height: {z:.9f}}}" for r, z in HALF_CIRCLE) + "], edge: %g}, seed: %d}"
WHY = {
    "in no order, another mesh for each seed": {"objects.ball.mesh": lambda edge, seed: UNORDERED % (edge, seed)},
    "turned, another way for each seed": {"objects.ball.rotation": lambda edge, seed: f"{{axis: [1, {seed}, 3], angle: {40 * seed}}}"},
    "another mesh seed": {"objects.ball.mesh.seed": 2},
    "jitter: 0.3": {"objects.ball.mesh.jitter": 0.3},
    "no scatter of strength": {"materials.concrete.weibull.modulus": 0},
    "safety: 0.45": {"fracture.safety": 0.45},
    "criterion: traction": {"fracture.criterion": "traction"},
    "friction_angle: 37": {"materials.concrete.friction_angle": 37},
    "fracture_energy_shear: 800": {"materials.concrete.fracture_energy_shear": 800},
}


def settings(body):
    """name: settings, of one body; the first is the scene as it is."""
    jitter = {"ball": "objects.ball.mesh.jitter", "tile": "objects.tile.mesh.jitter"}
    unresolved = f"materials.{BODIES[body]['material']}.unresolved"
    keep = {unresolved: "keep"}
    all_of_them = {
        "as it is": {},
        "criterion: traction": {"fracture.criterion": "traction", **keep},
        "criterion: traction, threshold: 0.9": {"fracture.criterion": "traction", "fracture.threshold": 0.9, **keep},
        "criterion: principal": {"fracture.criterion": "principal", **keep},
        "threshold: 0.9": {"fracture.threshold": 0.9},
        "check_every: 1": {"fracture.check_every": 1},
        "check_every: 10": {"fracture.check_every": 10},
    }
    if body in jitter:
        all_of_them |= {f"jitter: {j}": {jitter[body]: j} for j in (0, 0.3)}
    if body == "tile":
        all_of_them |= {f"pattern: {p}": {"objects.tile.mesh.box.pattern": p} for p in ("bricks", "unstructured")}
    if body != "ball":  # its cohesive zone is resolved, so that the word changes nothing
        own = "tip_strength" if body == "mug" else "keep"
        all_of_them |= {f"unresolved: {u}": {unresolved: u} for u in ("keep", "tip_strength", "scale_strength", "scale_energy") if u != own}
    return all_of_them


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
    for body, edges, seeds in (("tile", (12, 8, 6), 4), ("ball", (18, 12), 4), ("mug", (4, 3), 2)):
        what = BODIES[body]
        for edge, (name, values), seed in itertools.product(edges, settings(body).items(), SEEDS[:seeds]):
            size = CUP % (edge * 1e-3) if body == "mug" else edge * 1e-3
            yield f"{body}/{edge} mm/{name}/{seed}", what, {what["edge"]: size, **values, "seed": seed}


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
    """What the tables show of one run; `said` is what `run --json` printed."""
    with h5py.File(path) as run:
        x, tets, piece = run["/mesh/positions"][:], run["/mesh/elements"][:], run["/nodes/fragment"][-1]
        corners = x[tets]
        volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
        _, index, count = np.unique(piece, return_inverse=True, return_counts=True)
        share = np.bincount(index, volume) / volume.sum()
        centre = np.stack([np.bincount(index, volume * corners.mean(axis=1)[:, i]) for i in range(3)], axis=1) / np.bincount(index, volume)[:, None]
        contact = x[np.argmin(x[:, 2])]
        far, single = np.linalg.norm(centre - contact, axis=1) > FAR, count == 1
        place, area, bonds, damage = facets(run)
        dissipated = damage * area * run["/materials/fracture_energy"][0]
        shell = np.minimum(np.linalg.norm(place - contact, axis=1) // SHELL, SHELLS - 1).astype(int)
    by_shell = lambda what: [float(y) for y in np.bincount(shell, what, SHELLS)]
    return {"tets": len(tets), "pieces": len(count), "largest": float(share.max()), "single": int(single.sum()), "single_mass": float(share[single].sum()),
            "far_pieces": int(far.sum()), "far_single": int((far & single).sum()), "far_single_mass": float(share[far & single].sum()),
            "unopened": float(dissipated[bonds].sum()), "by_damage": float(dissipated.sum()),
            "shells": {"energy": by_shell(dissipated), "unopened": by_shell(dissipated * bonds), "failed": by_shell(area * ~bonds), "inserted": by_shell(area * (damage > 0))},
            "said": said}


def make(program, folder, name, body, values):
    """Runs what is not there yet."""
    kept = os.path.join(folder, name.replace("/", "__").replace(" ", "_").replace(":", "") + ".json")
    if os.path.exists(kept):
        return
    file, told = kept[:-5] + ".h5", kept + ".part"
    words = {**body["set"], **values, "threads": 1, "output.nodes": "true"}
    command = [program, "run", os.path.join(ROOT, "scenes", body["scene"] + ".yaml"), "--force", "--json", "--checkpoint", "0", "--output", file]
    for key, value in words.items():
        command += ["--set", f"{key}={value}"]
    print(name, file=sys.stderr, flush=True)
    with open(told, "w") as out, open(kept + ".log", "w") as log:
        child = subprocess.Popen(["prlimit", f"--cpu={LIMIT}", *command], stdout=out, stderr=log)
        _, status, usage = os.wait4(child.pid, 0)
    result = {"name": name, "seconds": usage.ru_utime, "status": status}
    if status == 0:
        with open(told) as out:
            result |= measure(file, json.load(out))
    with open(told, "w") as out:
        json.dump(result, out)
    os.replace(told, kept)
    for left in (file, file + ".checkpoint-1", file + ".checkpoint-2"):
        if os.path.exists(left):
            os.remove(left)


def kept(folder):
    """What was measured, by name of the run."""
    found = {}
    for file in sorted(os.listdir(folder)):
        if file.endswith(".json"):
            with open(os.path.join(folder, file)) as text:
                result = json.load(text)
            found[result["name"]] = result
    return found


def mean(values):
    """Mean and its standard error."""
    count = len(values)
    middle = sum(values) / count
    return middle, math.sqrt(sum((v - middle) ** 2 for v in values) / (count - 1) / count) if count > 1 else math.nan


def told(form, values):
    middle, error = mean(values)
    return form % middle + ("" if math.isnan(error) else " ± " + form % error)


QUANTITIES = [  # what, format, of a run
    ("kinetic energy, J", "%.1f", lambda r: r["said"]["kinetic"]),
    ("of that at the start, %", "%.1f", lambda r: 100 * r["said"]["kinetic"] / r["said"]["largest_energy"]),
    ("fracture energy, J", "%.2f", lambda r: r["said"]["fracture_dissipation"]),
    ("largest piece's share", "%.3f", lambda r: r["largest"]),
    ("pieces", "%.0f", lambda r: r["pieces"]),
    ("of those farther than 3 cm from the contact", "%.0f", lambda r: r["far_pieces"]),
    ("single tets among the latter, %", "%.2f", lambda r: 100 * r["far_single"] / max(r["far_pieces"], 1)),
    ("single tets, % of the mass in all", "%.3f", lambda r: 100 * r["single_mass"]),
    ("energy of facets that have not opened, % of the fracture energy", "%.1f", lambda r: 100 * r["unopened"] / r["by_damage"]),
    ("fracture energy by damage over that of the ledger", "%.3f", lambda r: r["by_damage"] / r["said"]["fracture_dissipation"]),
    ("fracture energy of facets that have opened, by damage, J", "%.2f", lambda r: r["by_damage"] - r["unopened"]),
    ("friction, J", "%.2f", lambda r: -r["said"]["friction"] - r["said"]["crack_friction"]),
    ("taken by closing faces, J", "%.2f", lambda r: -r["said"]["closure"]),
    ("taken by contact with the floor, J", "%.2f", lambda r: -r["said"]["contact"]),
    ("strain energy, and that of bonds, J", "%.2f", lambda r: r["said"]["strain"], lambda r: r["said"]["cohesive_recoverable"]),
    ("fracture energy within 3 cm of the contact, and beyond, J", "%.2f", lambda r: sum(r["shells"]["energy"][:3]), lambda r: sum(r["shells"]["energy"][3:])),
    ("area inserted, m²", "%.3f", lambda r: r["said"]["inserted_area"]),
    ("area failed, m²", "%.4f", lambda r: r["said"]["failed_area"]),
    ("facets inserted, failed", "%.0f", lambda r: r["said"]["inserted"], lambda r: r["said"]["failed"]),
    ("largest stress at insertion / strength", "%.1f", lambda r: r["said"]["worst_overshoot"]),
    ("residual of the ledger / largest energy", "%.1e", lambda r: abs(r["said"]["residual"]) / r["said"]["largest_energy"]),
    ("processor time, s", "%.0f", lambda r: r["seconds"]),
]


def convergence(found, title):
    edges = sorted({name.split("/")[1] for name in found if name.startswith(title + "/")}, key=lambda e: -float(e.split()[0]))
    of = {e: [r for name, r in found.items() if name.startswith(f"{title}/{e}/") and r["status"] == 0] for e in edges}
    edges = [e for e in edges if of[e]]
    if not edges:
        return
    print("| %s | %s |" % (title, " | ".join(f"{e}, {of[e][0]['tets']:,} tets" for e in edges)))
    print("|---" * (1 + len(edges)) + "|")
    print("| runs | " + " | ".join(str(len(of[e])) for e in edges) + " |")
    for what, form, *parts in QUANTITIES:
        cells = [", ".join(told(form, [part(r) for r in of[e]]) for part in parts) for e in edges]
        print(f"| {what} | " + " | ".join(cells) + " |")
    if len(edges) < 2:
        return
    coarse, fine = edges[-2], edges[-1]
    print(f"\n| target, {coarse} to {fine} | at most | found | |\n|---|---|---|---|")
    by_name = {what: part for what, _, part, *_ in QUANTITIES}
    for what, bound in (("kinetic energy, J", 0.05), ("fracture energy, J", 0.2)):
        (a, s), (b, t) = (mean([by_name[what](r) for r in of[e]]) for e in (coarse, fine))
        found_change, error = abs(b - a) / b, math.hypot(s / b, t * a / b**2)
        print(f"| {what.split(',')[0]} changes by | {bound:.0%} | {found_change:.1%} ± {error:.1%} | {'held' if found_change <= bound else 'missed'} |")
    (a, s), (b, t) = (mean([r["largest"] for r in of[e]]) for e in (coarse, fine))
    print(f"| largest share changes by | 0.1 | {abs(b - a):.3f} ± {math.hypot(s, t):.3f} | {'held' if abs(b - a) <= 0.1 else 'missed'} |")
    for what, bound in (("single tets among the latter, %", 30), ("single tets, % of the mass in all", 2),
                        ("energy of facets that have not opened, % of the fracture energy", 30)):
        worst, error = max(mean([by_name[what](r) for r in of[e]]) for e in edges)
        print(f"| {what}: the most of all meshes | {bound} | {worst:.2f} ± {error:.2f} | {'held' if worst <= bound else 'missed'} |")
    print()


def shells(found):
    """Fracture energy by distance from the contact, of facets that have opened and that have not."""
    bounds = (0, 3, 6, 9, SHELLS)
    print("| fracture energy in J, opened + not opened, by distance from the contact | %s |" % " | ".join(f"{a} to {b} cm" for a, b in itertools.pairwise(bounds)))
    print("|---" * len(bounds) + "|")
    for edge in (18, 12, 8):
        good = [r for name, r in found.items() if name.startswith(f"convergence/{edge} mm/") and r["status"] == 0]
        if good:
            part = lambda what, a, b: mean([sum(r["shells"][what][a:b]) for r in good])[0]
            cells = (f"{part('energy', a, b) - part('unopened', a, b):.2f} + {part('unopened', a, b):.2f}" for a, b in itertools.pairwise(bounds))
            print(f"| {edge} mm | " + " | ".join(cells) + " |")
    print()


def why(found):
    groups = {}
    for name, result in found.items():
        title, edge, *_ = name.split("/")
        if result["status"] == 0 and (title in ("convergence", "edges") or title.startswith("why ")):
            groups.setdefault((title[4:] if title.startswith("why ") else "as it is", edge), []).append(result)
    if not groups:
        return
    shown = [QUANTITIES[i] for i in (1, 2, 10, 3, 4, 8, 11, 12, 16, 18, 19)]
    print("| the ball | edge | runs | " + " | ".join(q[0] for q in shown) + " |\n" + "|---" * (3 + len(shown)) + "|")
    order = ["as it is", *WHY]
    for setting, edge in sorted(groups, key=lambda k: (order.index(k[0]), -float(k[1].split()[0]))):
        good = groups[setting, edge]
        cells = [", ".join(told(form, [part(r) for r in good]) for part in parts) for _, form, *parts in shown]
        print(f"| {setting} | {edge} | {len(good)} | " + " | ".join(cells) + " |")
    print()


def defaults(found, body):
    rows = {}
    for name, result in found.items():
        if name.startswith(body + "/"):
            _, edge, setting, _ = name.split("/")
            rows.setdefault((edge, setting), []).append(result)
    order = list(settings(body))
    for edge in sorted({e for e, _ in rows}, key=lambda e: -float(e.split()[0])):
        print(f"| {body}, {edge} | largest share | pieces | single tets, % of pieces | % of the mass | fracture energy, J | "
              "inserted | failed | stress at insertion | processor time, s | runs |")
        print("|---" * 11 + "|")
        for setting in sorted((s for e, s in rows if e == edge), key=order.index):
            good = [r for r in rows[edge, setting] if r["status"] == 0]
            lost = len(rows[edge, setting]) - len(good)
            if not good:
                print(f"| {setting} | none ended |" + " |" * 8 + f" 0 of {lost} |")
                continue
            cell = lambda form, part: told(form, [part(r) for r in good])
            print(f"| {setting} | {cell('%.3f', lambda r: r['largest'])} | {cell('%.0f', lambda r: r['pieces'])} | "
                  f"{cell('%.0f', lambda r: 100 * r['single'] / r['pieces'])} | {cell('%.2f', lambda r: 100 * r['single_mass'])} | "
                  f"{cell('%.3g', lambda r: r['said']['fracture_dissipation'])} | {cell('%.0f', lambda r: r['said']['inserted'])} | {cell('%.0f', lambda r: r['said']['failed'])} | "
                  f"{cell('%.1f', lambda r: r['said']['worst_overshoot'])} | {cell('%.2g', lambda r: r['seconds'])} | {len(good)}{f' of {len(good) + lost}' if lost else ''} |")
        print()


def main(program, folder, parts):
    os.makedirs(folder, exist_ok=True)
    for part in parts:
        for name, body, values in runs():
            if fnmatch.fnmatchcase(name, part + "*"):
                make(program, folder, name, body, values)
    found = kept(folder)
    convergence(found, "convergence")
    shells(found)
    why(found)
    for body in BODIES:
        defaults(found, body)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
