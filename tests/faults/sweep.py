#!/usr/bin/env python3
"""Faults all over whole processes of the program, and what became of them.

usage: sweep.py files|memory PROGRAM INJECTOR FAULTS

files: operations of `shiver run` on its files fail (INJECTOR: failing_files), once or from one on, for FAULTS faults over four scenes. After
each one the frames in the file are compared with those of a run without faults, and the run is resumed to its end and compared whole.
memory: allocations of nineteen commands fail (INJECTOR: failing_malloc), one or all from one on. What ended with 0 is compared with what the
command gives without faults.
Prints counts, and what must not be: ends with 1 if there is any.
"""
import collections
import errno
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SCENE = """\
shiver: 1
name: tiny
materials:
  chalk: {density: 1200, youngs_modulus: 50e6, poissons_ratio: 0.2, fracture_energy: 0.05, cohesive_strength: 20e3}
objects:
  bar: {mesh: {box: {size: [0.02, 0.02, 0.06], edge: 0.02}}, material: chalk, position: [0, 0, 0.031], velocity: [0, 0, -2]}
obstacles:
  floor: {plane: {normal: [0, 0, 1], offset: 0}, friction: 0.3}
duration: 0.005
output: {rate: 1000}
threads: 1
"""
SIGNALS_FROM = 124  # exit statuses from here on: a time limit, a signal, a shell, and what the program says when a user stopped it


def call(program, words, folder, injector=None, **faults):
    environment = dict(os.environ, GOMP_SPINCOUNT="300")
    if injector:
        environment["LD_PRELOAD"] = injector
        environment.update({f"SHIVER_FAIL_{name.upper()}": str(value) for name, value in faults.items()})
    try:
        return subprocess.run([program, *words], cwd=folder, env=environment, capture_output=True, text=True, errors="replace", timeout=300)
    except subprocess.TimeoutExpired as late:
        return subprocess.CompletedProcess(late.cmd, SIGNALS_FROM, "", "runs on and on")


def count_calls(program, words, folder, injector):
    result = call(program, words, folder, injector, count=1)
    found = re.findall(r"^failing_\w+: (\d+)$", result.stderr, re.MULTILINE)
    if result.returncode != 0 or not found:
        sys.exit(f"{words}: {result.returncode} {result.stderr}")
    return max(int(number) for number in found)


def spread(count, places):
    """Whole numbers from 1 to count, evenly, none twice."""
    return sorted({1 + round(i * (count - 1) / max(places - 1, 1)) for i in range(places)})


class Tally:
    def __init__(self):
        self.outcomes, self.wrong = collections.Counter(), []

    def note(self, group, outcome, what=None):
        self.outcomes[group, outcome] += 1
        if what is not None:
            self.wrong.append((group, outcome, what))
            print("WRONG", group, outcome, what, flush=True)

    def end(self):
        for (group, outcome), number in sorted(self.outcomes.items()):
            print(f"{number:6d}  {group}: {outcome}")
        print(f"{sum(self.outcomes.values()):6d}  in all, {len(self.wrong)} wrong")
        sys.exit(1 if self.wrong else 0)


# ---- files ----

VARIANTS = {
    "bullet": [],
    "bullet, nodes": ["--set", "output.nodes=true"],
    "pbd, bars": ["--set", "rigid.engine=pbd", "--set", "fracture.stabiliser=bars"],
    "analytic, over an old file": ["--set", "rigid.engine=analytic", "--force"],
}
MODES = {"EIO once": (errno.EIO, False), "no space from then on": (errno.ENOSPC, True), "EIO from then on": (errno.EIO, True)}


def tables(program, folder):
    """Every frame as text of 17 digits, a prefix of which is what a shorter run gives."""
    result = call(program, ["export", "csv", "run.h5", "--force", "--quiet", "--output", "csv"], folder)
    if result.returncode != 0:
        return None
    return [(folder / f"csv_{part}.csv").read_text() for part in ("trajectories", "ledger", "obstacles", "events")]


def describe(program, folder):
    """Frames, checksum and status of the run file; None: there is none that verifies."""
    result = call(program, ["info", "--verify", "--json", "run.h5"], folder)
    if result.returncode != 0:
        return None
    return {name: re.search(rf'"{name}": "?(\w+)', result.stdout)[1] for name in ("frames", "checksum", "status")}


class Files:
    """One scene, its run without faults, and the judge of runs with them."""

    def __init__(self, program, injector, variant, folder):
        self.program, self.injector, self.folder = program, injector, folder
        self.run = ["run", "tiny.yaml", "--output", "run.h5", "--quiet", "--checkpoint", "0.02", *VARIANTS[variant]]
        self.old = "--force" in self.run
        (folder / "tiny.yaml").write_text(SCENE)
        self.calls = count_calls(program, self.run, folder, injector)
        self.whole, self.tables = describe(program, folder), tables(program, folder)
        if self.old:  # another one, that must stay until the new one has a frame
            call(program, ["run", "tiny.yaml", "--output", "old.h5", "--quiet", "--set", "duration=0.002"], folder)
            self.old_sum = re.search(r'"checksum": "(\w+)', call(program, ["info", "--json", "old.h5"], folder).stdout)[1]

    def clean(self):
        for path in self.folder.glob("run.h5*"):
            path.unlink()
        if self.old:
            shutil.copy(self.folder / "old.h5", self.folder / "run.h5")

    def what_is_there(self, told):
        """What is wrong with the file after a failure; told: number of the frame that the message says is missing."""
        if not (self.folder / "run.h5").exists():
            return "no file" if told else None
        found = describe(self.program, self.folder)
        if not found:
            return "does not verify"
        if self.old and found["checksum"] == self.old_sum:
            return "the old file" if told else None
        if int(found["frames"]) < told:
            return f"{found['frames']} frames of {told}"
        parts = tables(self.program, self.folder)
        if not parts:
            return f"cannot be exported: {found}"
        for whole, part in zip(self.tables, parts):
            if not whole.startswith(part):
                return "other frames"
        return None

    def resume(self):
        words = [word for word in self.run if word != "--force"]
        if self.old and describe(self.program, self.folder)["checksum"] == self.old_sum:
            words.append("--force")  # nothing to go on with: the old file is another run's
        else:
            words.append("--resume")
        result = call(self.program, words, self.folder)
        if result.returncode != 0:
            return f"{words[-1]}: {result.stderr}"
        found = describe(self.program, self.folder)
        return None if found and found["checksum"] == self.whole["checksum"] else f"other bits: {found}"

    def fault(self, tally, group, at, number, always):
        self.clean()
        faults = {"from": at, "number": number, **({"all": 1} if always else {})}
        result = call(self.program, self.run, self.folder, self.injector, **faults)
        what = f"operation {at}: {result.returncode} {result.stderr.strip()}"
        if result.returncode < 0 or result.returncode >= SIGNALS_FROM:
            return tally.note(group, "signal", what)
        if result.returncode == 0:
            found = describe(self.program, self.folder)
            if not found or found["checksum"] != self.whole["checksum"]:
                return tally.note(group, "silent", f"{what} {found}")
            outcome = "a warning, and the run is whole" if "warning" in result.stderr else "did no harm"
        else:
            if "shiver: " not in result.stderr:
                return tally.note(group, "without a word", what)
            told = re.search(r"frame (\d+) of", result.stderr)
            wrong = self.what_is_there(int(told[1]) if told else 0)
            if wrong:
                return tally.note(group, "lost", f"{what}: {wrong}")
            outcome = "told of, and what was written is there"
        wrong = self.resume()
        if wrong:
            return tally.note(group, "not resumed", f"{what}: {wrong}")
        return tally.note(group, outcome)


def sweep_files(program, injector, faults, folder, tally):
    places = -(-faults // (len(VARIANTS) * len(MODES)))
    for variant in VARIANTS:
        own = folder / variant.replace(" ", "_").replace(",", "")
        own.mkdir()
        files = Files(program, injector, variant, own)
        for mode, (number, always) in MODES.items():
            for at in spread(files.calls, places):
                files.fault(tally, f"{variant}, {mode}", at, number, always)
            print(f"{variant}, {mode}: {sum(tally.outcomes.values())} faults so far", flush=True)
        print(f"{variant}: {files.calls} operations", flush=True)


# ---- memory ----

STUDY = "shiver_study: 1\nname: t\nvary: {duration: [0.002]}\nreference: {duration: 0.003}\nmeasures: [dissipated]\n"
CASE = """\
verification: 1
title: A bar breaks on the floor
scene: tiny.yaml
source: none
quantities:
  - {name: facets, measure: last(frame.inserted), reference: "0", compare: above}
"""
CUBE = """\
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
"""
FALLS = SCENE.replace("velocity: [0, 0, -2]", "velocity: [0, 0, -1]").replace("duration: 0.005", "duration: 0.002")
RIGID = SCENE.replace("fracture_energy: 0.05, cohesive_strength: 20e3", "breakable: false")
# Words of a command; what it writes begins with `out`.
COMMANDS = {
    "run": ["run", "tiny.yaml", "--output", "out.h5", "--quiet"],
    "check": ["check", "tiny.yaml"],
    "plan": ["plan", "tiny.yaml", "--trial", "0"],
    "mesh": ["mesh", "cube.obj", "--edge", "0.5", "--output", "out.msh"],
    "info --verify": ["info", "--verify", "r.h5"],
    "export csv": ["export", "csv", "r.h5", "--output", "out"],
    "export xdmf": ["export", "xdmf", "r.h5", "--output", "out"],
    "export vtk": ["export", "vtk", "r.h5", "--output", "out"],
    "export gltf": ["export", "gltf", "r.h5", "--output", "out"],
    "export usd": ["export", "usd", "r.h5", "--output", "out"],
    "export svg": ["export", "svg", "r.h5", "--output", "out"],
    "view": ["view", "r.h5", "--output", "out.html"],
    "study": ["study", "tiny.yaml", "study.yaml", "--output", "out"],
    "compare": ["compare", "rigid.yaml", "--steps", "1e-3", "--engines", "bullet,analytic", "--output", "out"],
    "survive": ["survive", "falls.yaml", "--shots", "2", "--output", "out"],
    "stability": ["stability", "tiny.yaml", "--k", "1", "--iterations", "1", "--at", "0.5", "--steps", "200", "--csv", "out.csv"],
    "verify": ["verify", "./tiny.case.yaml"],
    "materials": ["materials"],
    "generate": ["generate", "man"],
}


def outcome_of(program, result, folder):
    """What a command printed and wrote: texts and bytes by name, without what may differ."""
    printed = re.sub(r"[\d.]+ s\b", "# s", result.stdout).encode()
    found = {"what it prints": without_numbers(printed) if "mesh" in result.args else printed}
    for path in sorted(folder.glob("out*")):
        for file in [path] if path.is_file() else sorted(path.rglob("*")):
            if file.is_file():
                found[str(file.relative_to(folder))] = file.read_bytes()
    if "out.msh" in found:  # gmsh's meshes depend on its environment, in which the faults stand
        found["out.msh"] = b""
    if "out.h5" in found:  # holds times of day and run times beside what must be equal
        found["out.h5"] = re.search(r'"checksum": "\w+', call(program, ["info", "--json", "out.h5"], folder).stdout)[0].encode()
    return found


def without_numbers(data):
    """Nor what stands by them in a table: spaces, and the star of whoever is on a Pareto front of run times."""
    return re.sub(rb"[ *]+", b" ", re.sub(rb"[-+]?\d[-+.\w]*", b"#", data))


def compare(one, other, like):
    """Where two outcomes differ. like: two without faults; what differs between them is compared without its numbers, or not at all."""
    if one.keys() != other.keys():
        return f"other files: {sorted(one.keys() ^ other.keys())}"
    for name in one:
        first, second = like[0].get(name), like[1].get(name)
        if first == second and one[name] != other[name]:
            return name
        if without_numbers(first) == without_numbers(second) and without_numbers(one[name]) != without_numbers(other[name]):
            return f"{name}, beside its numbers"
    return None


def sweep_command(program, injector, name, number, folder, tally):
    def clean():
        for path in folder.glob("out*"):
            shutil.rmtree(path) if path.is_dir() else path.unlink()

    words, like = COMMANDS[name], []
    for _ in range(2):
        clean()
        like.append(outcome_of(program, call(program, words, folder), folder))
    clean()
    if call(program, words, folder).returncode != 0:
        print(f"{name}: left out, this build of the program cannot do it", flush=True)
        return
    clean()
    calls = count_calls(program, words, folder, injector)
    half = -(-number // 4)  # evenly, and closer together at the beginning, where the program sets up
    places = sorted(set(spread(calls, half)) | {round(calls ** (i / half)) for i in range(half)})
    for always in (False, True):
        for at in places:
            clean()
            faults = {"from": at, "in": pathlib.Path(program).name, **({"all": 1} if always else {})}
            result = call(program, words, folder, injector, **faults)
            group = f"{name}, {'all from one on' if always else 'one'}"
            what = f"allocation {at}: {result.returncode} {result.stderr.strip()}"
            if result.returncode < 0 or result.returncode >= SIGNALS_FROM:
                tally.note(group, "signal", what)
            elif result.returncode == 0:
                wrong = compare(outcome_of(program, result, folder), like[0], like)
                if wrong:
                    tally.note(group, "silent", f"{what}: {wrong}")
                else:
                    tally.note(group, "works all the same")
            elif not result.stderr.strip():
                tally.note(group, "without a word", what)
            elif "memory" not in result.stderr:
                tally.note(group, "status and a message of something else")
                print(what, flush=True)
            else:
                tally.note(group, "status and a message")
    print(f"{name}: {calls} allocations", flush=True)


def sweep_memory(program, injector, faults, folder, tally):
    texts = {"tiny.yaml": SCENE, "falls.yaml": FALLS, "rigid.yaml": RIGID, "study.yaml": STUDY, "tiny.case.yaml": CASE, "cube.obj": CUBE}
    for file, text in texts.items():
        (folder / file).write_text(text)
    call(program, ["run", "tiny.yaml", "--output", "r.h5", "--quiet"], folder)
    for name in COMMANDS:
        sweep_command(program, injector, name, -(-faults // len(COMMANDS)), folder, tally)


def main():
    if len(sys.argv) != 5 or sys.argv[1] not in ("files", "memory"):
        sys.exit(__doc__)
    program, injector = (str(pathlib.Path(word).resolve()) for word in sys.argv[2:4])
    tally = Tally()
    with tempfile.TemporaryDirectory(prefix="shiver-sweep-") as folder:
        sweep = sweep_files if sys.argv[1] == "files" else sweep_memory
        sweep(program, injector, int(sys.argv[4]), pathlib.Path(folder), tally)
    tally.end()


main()
