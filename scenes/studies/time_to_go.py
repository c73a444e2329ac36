#!/usr/bin/env python3
"""Is the time to go that `shiver run` shows true, and the range of `shiver plan`? Runs scenes under a terminal of their own and compares
what it tells, from a quarter of the run on, with what it then took: a figure where nothing has cracked, else a range. The program guesses in
run time; a shared machine makes that uneven, so both are taken in processor time, the guess at the rate of processor to run time so far.
usage: scenes/studies/time_to_go.py PROGRAM [SCENE …]; prints a table, a line a scene"""
import os, pty, re, statistics, subprocess, sys, tempfile

FACTOR, FROM = 1.5, 0.25
START = 0.3  # s: start of the program and its run file, which a plan leaves out
SCENES = """rigid/pile hybrid/bar_on_point hybrid/two_balls slab_on_stone hybrid/wall_and_ball hybrid/stack_of_plates household/floor_tile
hybrid/ball_on_plate hybrid/second_generation household/brick_stack""".split()

LINE = re.compile(r" (\d+) s run, (?:time to go: cannot tell yet|about (\S+) s to go|(\S+) to (\S+) s to go)")


def processor_time(process):
    with open(f"/proc/{process}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def run(program, scene, folder):
    """Guesses of a run: (processor time so far, processor time to go or None, least, most), and all of its processor time."""
    child, terminal = pty.fork()
    if child == 0:
        os.execv(program, [program, "run", scene, "--set", "threads=1", "--force", "-o", os.path.join(folder, "run.h5")])
    guesses, text = [], ""
    while True:
        try:
            text += os.read(terminal, 65536).decode(errors="replace")
        except OSError:
            break
        end = 0
        for line in LINE.finditer(text):
            wall, to_go, low, high = [float(x) if x else None for x in line.groups()]
            spent, end = processor_time(child), line.end()
            if wall > 0:
                guesses.append((spent, *[x and x * spent / wall for x in (to_go, low, high)]))
        text = text[end:]
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
    print(f"| scene | processor time, s | guesses from a quarter on | figures | within {FACTOR} | ranges | hold | truth/middle of the range: "
          "median, and 5 … 95 % | `plan`, s | held |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            path = scene if os.path.exists(scene) else os.path.join(root, scene + ".yaml")
            guesses, all_of_it = run(program, path, folder)
            late = [(s, *g) for s, *g in guesses if FROM * all_of_it <= s < 0.98 * all_of_it]
            figures = [g / (all_of_it - s) for s, g, _, _ in late if g is not None]
            good = sum(1 / FACTOR <= ratio <= FACTOR for ratio in figures)
            ranges = [(low, all_of_it - s, high) for s, _, low, high in late if low is not None]
            held_ranges = sum(low <= truth <= high for low, truth, high in ranges)
            ratios = sorted(truth / (low * high) ** 0.5 for low, truth, high in ranges)
            said, held = plan(program, path, all_of_it)
            at = lambda share: ratios[min(len(ratios) - 1, int(share * len(ratios)))]
            span = f"{statistics.median(ratios):.2f}, {at(0.05):.2f} … {at(0.95):.2f}" if ratios else "–"
            percent = lambda part, whole: f"{100 * part / whole:.0f} %" if whole else "–"
            print(f"| {scene} | {all_of_it:.1f} | {len(late)} | {percent(len(figures), len(late))} | {percent(good, len(figures))} | "
                  f"{percent(len(ranges), len(late))} | {percent(held_ranges, len(ranges))} | {span} | {said} | {held} |", flush=True)


main(sys.argv[1], sys.argv[2:] or SCENES)
