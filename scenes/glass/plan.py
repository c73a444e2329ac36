#!/usr/bin/env python3
"""Plan of a cracked pane, the first object of its scene, before it moved: facets by damage (grey above 0.02, orange above 0.5, black above
0.99), seen across its thinnest direction.

usage: plan.py RUN.h5 PICTURE TIME,TIME,…   (a run with `output: {nodes: true}`; takes python3-h5py, python3-matplotlib)
       plan.py arms RUN.h5 TIME RADIUS,RADIUS,… [GAP]     arms of the star, mm: directions in which facets with a damage of more than a half
                                                          cross circles round the middle, as far apart as GAP (4 mm) at least
"""
import sys

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot
from matplotlib.collections import LineCollection

CORNERS_OF_FACET = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))
COLOURS = ((0.02, 0.5, "0.7"), (0.5, 0.99, "tab:orange"), (0.99, np.inf, "black"))


def edges_between(low, high, corners, damage, axes=(0, 1)):
    edges = []
    for facet, nodes in enumerate(CORNERS_OF_FACET):
        chosen = (damage[:, facet] > low) & (damage[:, facet] <= high)
        plan = corners[chosen][:, nodes][..., axes]
        edges += [np.stack([plan[:, a], plan[:, b]], 1) for a, b in ((0, 1), (1, 2), (2, 0))]
    return np.concatenate(edges)


def main(run, picture, times):
    with h5py.File(run) as file:
        of_frame = file["trajectory/time"][()]
        pane = slice(*file["mesh/object_ranges"][0][:2])
        corners = file["mesh/positions"][()][file["mesh/elements"][pane]]
        low_end, high_end = corners.min((0, 1)), corners.max((0, 1))
        axes = tuple(sorted(np.argsort(high_end - low_end)[1:]))
        frames = [int(np.argmin(abs(of_frame - time))) for time in times]
        figure, panels = pyplot.subplots(1, len(frames), figsize=(10, 10 / len(frames) + 0.2), squeeze=False)
        for panel, frame in zip(panels[0], frames):
            damage = file["nodes/damage"][frame][pane]
            for low, high, colour in COLOURS:
                panel.add_collection(LineCollection(edges_between(low, high, corners, damage, axes), colors=colour, linewidths=0.5))
            panel.set(xlim=(low_end[axes[0]], high_end[axes[0]]), ylim=(low_end[axes[1]], high_end[axes[1]]))
            panel.set_aspect("equal")
            panel.set_title(f"{of_frame[frame] * 1e3:g} ms")
            panel.tick_params(labelsize=6)
    figure.tight_layout()
    figure.savefig(picture, dpi=110)


def arms(run, time, radii, gap=4.0):
    with h5py.File(run) as file:
        frame = int(np.argmin(abs(file["trajectory/time"][()] - time)))
        corners = file["mesh/positions"][()][file["mesh/elements"][()]]
        edges = edges_between(0.5, np.inf, corners, file["nodes/damage"][frame])
    place = edges - corners.reshape(-1, 3).mean(0)[:2]
    distance = np.linalg.norm(place, axis=2)
    counts = []
    for radius in radii:
        crossing = (distance.min(1) < radius * 1e-3) & (distance.max(1) >= radius * 1e-3)
        middle = place[crossing].mean(1)
        turn = np.sort(np.arctan2(middle[:, 1], middle[:, 0]))
        counts.append(int((np.diff(turn, append=turn[:1] + 2 * np.pi) > gap / radius).sum()))
    return counts


if sys.argv[1] == "arms":
    print(*arms(sys.argv[2], float(sys.argv[3]), [float(r) for r in sys.argv[4].split(",")], *map(float, sys.argv[5:])))
else:
    main(sys.argv[1], sys.argv[2], [float(time) for time in sys.argv[3].split(",")])
