#!/usr/bin/env python3
"""How much too stiff a pane's mesh is in bending, with linear tets and with strain smoothed over edges.

usage: bending.py RUN.h5...     runs of scenes/glass/window_and_brick.yaml, however short: --set duration=1us --set objects.pane.mesh.box.edge=7mm

The ends of the pane are turned against each other by a small angle, all else is free; the energy of the static solution over that of
a beam, E I θ²/(2 L). The matrices are made here from the nodes and tets alone. Takes python3-h5py, python3-scipy.
"""
import sys

import h5py
import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import spsolve

MODULUS, RATIO, THICKNESS = 70e9, 0.22, 4e-3
TET_EDGES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
# rows of strain (xx, yy, zz, yz, xz, xy): component of the displacement, and direction of its slope
STRAIN = ((0, 0, 0), (1, 1, 1), (2, 2, 2), (3, 1, 2), (3, 2, 1), (4, 0, 2), (4, 2, 0), (5, 0, 1), (5, 1, 0))


def strains(positions, tets):
    """Six rows a tet over the displacements, and the volumes."""
    corners = positions[tets]
    edges = np.stack([corners[:, k] - corners[:, 0] for k in (1, 2, 3)], 2)
    slopes = np.linalg.inv(edges)
    slopes = np.concatenate([-slopes.sum(1, keepdims=True), slopes], 1)
    number = np.arange(len(tets))
    entries = [(slopes[:, corner, along], 6 * number + row, 3 * tets[:, corner] + component)
               for corner in range(4) for row, component, along in STRAIN]
    values, rows, columns = (np.concatenate(part) for part in zip(*entries))
    return sparse.csr_matrix((values, (rows, columns)), shape=(6 * len(tets), positions.size)), np.linalg.det(edges) / 6


def means_over_edges(tets, volumes):
    """Of six numbers a tet, by volume over the tets round each edge; and the volumes of the edges."""
    ends = np.concatenate([np.sort(tets[:, pair], 1) for pair in TET_EDGES])
    edges, edge = np.unique(ends, axis=0, return_inverse=True)
    edge, tet, share = edge.ravel(), np.tile(np.arange(len(tets)), 6), np.tile(volumes / 6, 6)
    whole = np.bincount(edge, share, len(edges))
    mean = sparse.csr_matrix((share / whole[edge], (edge, tet)), shape=(len(edges), len(tets)))
    return sparse.kron(mean, sparse.identity(6)), whole


def stiffness(positions, tets, smoothed):
    of_tets, volumes = strains(positions, tets)
    if smoothed:
        mean, volumes = means_over_edges(tets, volumes)
        of_tets = mean @ of_tets
    shear = MODULUS / 2 / (1 + RATIO)
    law = np.diag([2 * shear] * 3 + [shear] * 3)
    law[:3, :3] += MODULUS * RATIO / ((1 + RATIO) * (1 - 2 * RATIO))
    return (of_tets.T @ sparse.kron(sparse.diags(volumes), law) @ of_tets).tocsr()


def over_beam(positions, matrix, angle=1e-4):
    half = positions[:, 0].max()
    ends = np.flatnonzero(abs(abs(positions[:, 0]) - half) < 1e-9)
    held = {3 * node: -angle * np.sign(positions[node, 0]) * positions[node, 1] for node in ends}
    for side in (-1, 1):  # nothing may move as a whole
        end = ends[side * positions[ends, 0] > 0]
        middle = end[np.argmin(np.hypot(positions[end, 1], positions[end, 2]))]
        held |= {3 * middle + 1: 0.0, 3 * middle + 2: 0.0}
    held[3 * end[np.argmax(positions[end, 2] - abs(positions[end, 1]))] + 1] = 0.0
    known = np.array(list(held))
    u = np.zeros(positions.size)
    u[known] = list(held.values())
    free = np.setdiff1d(np.arange(positions.size), known)
    u[free] = spsolve(matrix[free][:, free].tocsc(), -(matrix[free][:, known] @ u[known]))
    width = np.ptp(positions[:, 2])
    return 0.5 * u @ (matrix @ u) / (0.5 * MODULUS * width * THICKNESS**3 / 12 * angle**2 / half * 2)


def main(run):
    with h5py.File(run) as file:
        positions, tets = file["mesh/positions"][()], file["mesh/elements"][()]
    tets = tets[(abs(positions[tets][..., 1]) < 0.5 * THICKNESS * 1.001).all(1)]
    nodes, tets = np.unique(tets, return_inverse=True)
    positions, tets = positions[nodes], tets.reshape(-1, 4)
    results = [over_beam(positions, stiffness(positions, tets, smoothed)) for smoothed in (False, True)]
    print(f"{run}: linear tets {results[0]:.2f}, smoothed edges {results[1]:.2f}", flush=True)


for name in sys.argv[1:]:
    main(name)
