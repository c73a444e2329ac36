#!/usr/bin/env python3
"""The expanding bar by other means: a line of springs whose planes open by a linear law, for the cases expanding_bar*.

Lengths are in E G/strength^2, speeds in sqrt(E/density), stresses in the strength, so that E, density, strength and G are 1. A plane is
tied until the mean stress of the cells beside it reaches its strength; from then on its traction falls with the largest opening so far and
goes back to zero with the opening; faces do not pass through each other. The traction is that at the end of each step, so that no step is too
long for it. Each plane of the bar in space has facets with strengths of their own: here it has the mean of two draws.

usage: bar_1d.py [SEEDS [CELLS_A_PIECE]]   prints, for five rates, the mean length of pieces over the fit of Zhou, Molinari and Ramesh
"""
import sys

import numpy as np

RATES = (0.1, 0.3, 1.0, 3.0, 10.0)
PIECES = 60  # lengths of the fit in a bar, as in the case
COURANT = 0.3
MODULUS = 20


def fitted_length(rate):
    return 4.5 / (1 + 0.77 * rate**0.25 + 5.4 * rate**0.75)


def traction_of_open(largest, strength, final, free, gain):
    """Traction at the end of a step in which the opening becomes free - gain * traction."""
    softening = strength * (1 - free / final) / (1 - strength * gain / final)
    held = strength * np.maximum(1 - largest / final, 0) / np.where(largest > 0, largest, 1e-300)
    unloading = free / (1 / np.maximum(held, 1e-300) + gain)
    closed = free / gain  # what brings the opening to zero
    traction = np.where(free - gain * softening > largest, softening, unloading)
    traction = np.where(largest >= final, 0, traction)
    return np.where(free < 0, closed, np.maximum(traction, 0))


def pieces(rate, cells, seed):
    length = PIECES * fitted_length(rate)
    size = length / cells
    step = COURANT * size
    kick = 2 * step / size  # velocity that a stress gives the end of a cell, half the cell's mass, in a step
    strength = np.random.default_rng(seed).weibull(MODULUS, (2, cells - 1)).mean(0)
    final = 2 / strength
    place = np.linspace(-length / 2, length / 2, cells + 1)
    left, right = rate * place[:-1], rate * place[1:]  # velocities of both ends of each cell; the bar's own ends keep theirs
    stretch = np.zeros(cells)
    opening, largest = np.zeros(cells - 1), np.zeros(cells - 1)
    opened = np.zeros(cells - 1, bool)
    for _ in range(int((1.5 / rate + 12) / step)):
        opened |= 0.5 * (stretch[:-1] + stretch[1:]) >= strength
        before, after = right[:-1] - kick * stretch[:-1], left[1:] + kick * stretch[1:]
        together = 0.5 * (before + after)
        free = opening + step * (after - before)
        traction = traction_of_open(largest, strength, final, free, 2 * step * kick)
        right[:-1] = np.where(opened, before + kick * traction, together)
        left[1:] = np.where(opened, after - kick * traction, together)
        opening = np.where(opened, opening + step * (left[1:] - right[:-1]), 0)
        largest = np.maximum(largest, opening)
        stretch += step * (right - left) / size
    return length / (int((largest >= 0.99 * final).sum()) + 1)


def main(seeds=8, cells_a_piece=8):
    for rate in RATES:
        ratios = [pieces(rate, PIECES * cells_a_piece, seed) / fitted_length(rate) for seed in range(seeds)]
        print(f"rate {rate:g}: {np.mean(ratios):.3f} +- {np.std(ratios, ddof=1) / np.sqrt(seeds):.3f}")


main(*(int(argument) for argument in sys.argv[1:3]))
