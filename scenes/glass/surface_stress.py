#!/usr/bin/env python3
"""Largest tension in the two flat sides of a pane, from the places of their nodes alone, and by Weibull the chance that it has broken.

usage: surface_stress.py RUN.h5 [AXIS [THICKNESS]]     a run with `output: {nodes: true}` and `fracture: {enabled: false}`; AXIS, 0 to 2, is
                                                         that across the pane (1), THICKNESS its own, m (4e-3), about the origin

Modulus, ratio and the strength of 0.2134 m² with its exponent are those of the library's soda-lime glass (docs/materials.md). Takes
python3-h5py.
"""
import sys

import h5py
import numpy as np

MODULUS, RATIO = 70e9, 0.22
STRENGTH, AREA, EXPONENT = 40e6, 0.2134, 7.0
CORNERS_OF_FACE = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))
LEVELS = (30e6, 50e6, 80e6, 120e6)


def faces_of_sides(positions, elements, axis, thickness):
    of_pane = (abs(positions[elements][..., axis]) < 0.5 * thickness * 1.001).all(1).nonzero()[0]
    tets, corners = [], []
    for side in (-1, 1):
        lies_on = abs(positions[:, axis] - side * 0.5 * thickness) < 1e-3 * thickness
        for face in CORNERS_OF_FACE:
            chosen = of_pane[lies_on[elements[of_pane][:, face]].all(1)]
            tets.append(chosen)
            corners += [face] * len(chosen)
    return np.concatenate(tets), np.array(corners)


def sides_in_plane(place):
    """Two sides of each triangle in axes of its own, as columns."""
    first, second = place[:, 1] - place[:, 0], place[:, 2] - place[:, 0]
    along = first / np.linalg.norm(first, axis=1)[:, None]
    across = second - (second * along).sum(1)[:, None] * along
    across /= np.linalg.norm(across, axis=1)[:, None]
    return np.stack([(side * axis).sum(1) for axis in (along, across) for side in (first, second)], 1).reshape(-1, 2, 2)


def tension(reference, present):
    inverse = np.linalg.inv(reference)
    stretch = np.stack([present[:, 1] - present[:, 0], present[:, 2] - present[:, 0]], 2)
    metric = np.einsum("nki,nkj->nij", stretch, stretch)
    strain = 0.5 * (np.einsum("nki,nkl,nlj->nij", inverse, metric, inverse) - np.eye(2))
    scale = MODULUS / (1 - RATIO**2)
    x, y = scale * (strain[:, 0, 0] + RATIO * strain[:, 1, 1]), scale * (strain[:, 1, 1] + RATIO * strain[:, 0, 0])
    shear = scale * (1 - RATIO) * strain[:, 0, 1]
    return 0.5 * (x + y) + np.hypot(0.5 * (x - y), shear)


def main(run, axis=1, thickness=4e-3):
    with h5py.File(run) as file:
        positions, elements = file["mesh/positions"][()], file["mesh/elements"][()]
        tets, corners = faces_of_sides(positions, elements, axis, thickness)
        reference = sides_in_plane(positions[elements[tets[:, None], corners]])
        area = 0.5 * abs(np.linalg.det(reference))
        print("time, ms   strain energy, J   largest, MPa   cm² above " + ", ".join(f"{level / 1e6:g}" for level in LEVELS) + " MPa   broken")
        for frame, time in enumerate(file["trajectory/time"][()]):
            place = file["nodes/corners"][frame].reshape(-1, 4, 3)[tets[:, None], corners].astype(float)
            pull = tension(reference, place)
            chance = 1 - np.exp(-((np.maximum(pull, 0) / STRENGTH) ** EXPONENT * area).sum() / AREA)
            above = ", ".join(f"{area[pull > level].sum() * 1e4:.1f}" for level in LEVELS)
            print(f"{time * 1e3:8.3f}   {file['ledger'][frame]['strain']:16.3f}   {pull.max() / 1e6:12.0f}   {above}   {chance:.2f}")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], *(kind(value) for kind, value in zip((int, float), sys.argv[2:])))
