#!/usr/bin/env python3
"""Frequencies of the slowest vibrations of a free body, the first object of a run file, by quadratic tets on its mesh: what the slowest mode
of a fragment, by whose rate `loss_factor` damps it, is held against (docs/decisions.md). Takes python3-h5py and python3-scipy.
usage: scenes/studies/free_modes.py RUN.h5 DENSITY [COUNT]      prints Hz"""
import itertools, sys

import h5py
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import eigsh

EDGES = list(itertools.combinations(range(4), 2))


def shapes(b):
    """Values and barycentric derivatives of the ten functions at barycentric coordinates b."""
    value = [x * (2 * x - 1) for x in b] + [4 * b[i] * b[j] for i, j in EDGES]
    slope = np.zeros((10, 4))
    for i in range(4):
        slope[i, i] = 4 * b[i] - 1
    for k, (i, j) in enumerate(EDGES):
        slope[4 + k, i], slope[4 + k, j] = 4 * b[j], 4 * b[i]
    return np.array(value), slope


def mass_of_unit_volume():
    """∫ NᵢNⱼ / V, exactly: ∫ of a monomial of barycentric coordinates is 6 Π pᵢ! / (3 + Σ pᵢ)! V; here by Gauss points, collapsed."""
    x, w = np.polynomial.legendre.leggauss(5)
    x, w = 0.5 * (x + 1), 0.5 * w
    mass = np.zeros((10, 10))
    for (a, wa), (b, wb), (c, wc) in itertools.product(zip(x, w), repeat=3):
        p, q, r = a, b * (1 - a), c * (1 - a) * (1 - b)
        n, _ = shapes((1 - p - q - r, p, q, r))
        mass += 6 * wa * wb * wc * (1 - a) ** 2 * (1 - b) * np.outer(n, n)
    return mass


def stiffness(corners, moduli):
    """30 × 30 per tet, by four points, which is exact for straight sides."""
    first, second = moduli
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    gradient = np.linalg.inv(np.concatenate([np.ones((len(corners), 4, 1)), corners], 2))[:, 1:, :]
    total = np.zeros((len(corners), 10, 3, 10, 3))
    for k in range(4):
        b = np.full(4, 0.1381966011250105)
        b[k] = 0.5854101966249685
        d = np.einsum("nb,tjb->tnj", shapes(b)[1], gradient)
        dot = np.einsum("tai,tbi->tab", d, d)
        part = first * np.einsum("tai,tbj->taibj", d, d) + second * np.einsum("taj,tbi->taibj", d, d)
        for i in range(3):
            part[:, :, i, :, i] += second * dot
        total += 0.25 * volume[:, None, None, None, None] * part
    return volume, total.reshape(-1, 30, 30)


def main(run, density, count=4):
    with h5py.File(run) as file:
        nodes, tets = file["mesh/object_ranges"][0][2:], file["mesh/object_ranges"][0][:2]
        elements, positions = file["mesh/elements"][tets[0]:tets[1]], file["mesh/positions"][()]
        name = file["mesh/object_materials"][0]
        place = list(file["materials/name"][()]).index(name)
        modulus, poisson = file["materials/youngs_modulus"][place], file["materials/poissons_ratio"][place]
    pairs = np.sort(np.stack([elements[:, e] for e in EDGES], 1).reshape(-1, 2), 1)
    _, middle = np.unique(pairs, axis=0, return_inverse=True)
    used, corner = np.unique(elements, return_inverse=True)
    ten = np.concatenate([corner.reshape(-1, 4), len(used) + middle.reshape(-1, 6)], 1)
    moduli = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson)), modulus / (2 + 2 * poisson)
    volume, k = stiffness(positions[elements], moduli)
    m = density * volume[:, None, None] * np.kron(mass_of_unit_volume(), np.eye(3))
    place = (3 * ten[:, :, None] + np.arange(3)).reshape(-1, 30)
    rows, columns = np.repeat(place, 30, 1).ravel(), np.tile(place, 30).ravel()
    size = 3 * (ten.max() + 1)
    k, m = (coo_matrix((x.ravel(), (rows, columns)), (size, size)).tocsc() for x in (k, m))
    scale = (2 * np.pi * 100) ** 2  # below all that vibrates; six motions of the body as a whole have none
    values = np.sort(eigsh(k, 6 + count, m, sigma=-scale, return_eigenvectors=False))[6:]
    print(*(f"{f:.0f}" for f in np.sqrt(values) / (2 * np.pi)))


main(sys.argv[1], float(sys.argv[2]), *map(int, sys.argv[3:]))
