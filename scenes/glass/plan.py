#!/usr/bin/env python3
"""Plan of a cracked pane: facets by damage (grey above 0.02, orange above 0.5, black above 0.99), seen along z.

usage: plan.py RUN.h5 PICTURE TIME,TIME,…   (a run with `output: {nodes: true}`; takes python3-h5py, python3-matplotlib)
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


def edges_between(low, high, corners, damage):
    edges = []
    for facet, nodes in enumerate(CORNERS_OF_FACET):
        chosen = (damage[:, facet] > low) & (damage[:, facet] <= high)
        plan = corners[chosen][:, nodes, :2]
        edges += [np.stack([plan[:, a], plan[:, b]], 1) for a, b in ((0, 1), (1, 2), (2, 0))]
    return np.concatenate(edges)


def main(run, picture, times):
    with h5py.File(run) as file:
        of_frame = file["trajectory/time"][()]
        frames = [int(np.argmin(abs(of_frame - time))) for time in times]
        figure, panels = pyplot.subplots(1, len(frames), figsize=(10, 3.5), squeeze=False)
        for panel, frame in zip(panels[0], frames):
            corners = file["nodes/corners"][frame].reshape(-1, 4, 3)
            damage = file["nodes/damage"][frame]
            for low, high, colour in COLOURS:
                panel.add_collection(LineCollection(edges_between(low, high, corners, damage), colors=colour, linewidths=0.5))
            panel.set(xlim=(corners[..., 0].min(), corners[..., 0].max()), ylim=(corners[..., 1].min(), corners[..., 1].max()))
            panel.set_aspect("equal")
            panel.set_title(f"{of_frame[frame] * 1e3:g} ms")
            panel.tick_params(labelsize=6)
    figure.tight_layout()
    figure.savefig(picture)


main(sys.argv[1], sys.argv[2], [float(time) for time in sys.argv[3].split(",")])
