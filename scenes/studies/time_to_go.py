#!/usr/bin/env python3
"""Is the time to go that `shiver run` shows true, and the range of `shiver plan`? Runs scenes under a terminal of their own and compares
each guess, from a quarter of the run on, with what it then took. The program guesses in run time; a shared machine makes that uneven, so both
are taken in processor time, the guess at the rate of processor to run time so far.
usage: scenes/studies/time_to_go.py PROGRAM [SCENE …]; prints a table, a line a scene"""
import os, pty, re, subprocess, sys, tempfile

FACTOR, FROM = 1.5, 0.25
START = 0.3  # s: start of the program and its run file, which a plan leaves out
SCENES = """household/heap household/vase hybrid/ball_on_plate hybrid/stack_of_plates hybrid/bar_on_point hybrid/two_balls hybrid/wall_and_ball
rigid/pile slab_on_stone rigid/stack_of_boxes""".split()


def processor_time(process):
    with open(f"/proc/{process}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def run(program, scene, folder):
    """Guesses of a run: (processor time so far, processor time to go or None), and all of its processor time."""
    child, terminal = pty.fork()
    if child == 0:
        os.execv(program, [program, "run", scene, "--set", "threads=1", "--force", "-o", os.path.join(folder, "run.h5")])
    guesses, text = [], ""
    while True:
        try:
            text += os.read(terminal, 65536).decode(errors="replace")
        except OSError:
            break
        for line in re.findall(r" (\d+) s run, ([^\r\n]*)", text):
            spent = processor_time(child)
            told = re.search(r"about (\S+) s to go", line[1])
            wall = float(line[0])
            if wall > 0:
                guesses.append((spent, float(told[1]) * spent / wall if told else None))
        text = ""
    usage = os.wait4(child, 0)[2]
    return guesses, usage.ru_utime + usage.ru_stime


def plan(program, scene, truth):
    """What it says of the run time, and whether that holds: within its range, which is of this machine's uneven processor, by a quarter."""
    text = subprocess.run([program, "plan", scene, "--set", "threads=1"], capture_output=True, text=True).stdout
    line = re.search(r"run time of the scene: (.*)", text)[1]
    if "cannot tell" in line:
        return "cannot tell", "says so"
    span = re.search(r"([0-9.e+-]+) to ([0-9.e+-]+) s", line)
    low, high = (float(span[1]), float(span[2])) if span else (float(line.split()[0]),) * 2
    return f"{low:.3g} to {high:.3g}" if span else f"{low:.3g}, all of it", "yes" if low / 1.25 - START <= truth <= high * 1.25 + START else "no"


def main(program, scenes):
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
    print("| scene | processor time, s | guesses from a quarter on | told | of them within 1.5 | least and most of guess/truth | `plan`, s | held |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            path = scene if os.path.exists(scene) else os.path.join(root, scene + ".yaml")
            guesses, all_of_it = run(program, path, folder)
            late = [(s, g) for s, g in guesses if FROM * all_of_it <= s < 0.98 * all_of_it]
            ratios = [g / (all_of_it - s) for s, g in late if g is not None]
            good = sum(1 / FACTOR <= r <= FACTOR for r in ratios)
            said, held = plan(program, path, all_of_it)
            span = f"{min(ratios):.2f} … {max(ratios):.2f}" if ratios else "–"
            print(f"| {scene} | {all_of_it:.1f} | {len(late)} | {len(ratios)} | {good} | {span} | "
                  f"{said} | {held} |", flush=True)


main(sys.argv[1], sys.argv[2:] or SCENES)
