#!/usr/bin/env python3
"""How often does central difference feed pieces of few tets? Leapfrog with Green strain, written apart from the program: pieces cut out
of a random mesh, shaken at random, stepped at a share of the smallest stable step of their tets. Prints how many of them gain half of
their energy or more, the table of docs/decisions.md ("A lone tet resonates with the step").
usage: scenes/studies/resonance.py [FADING]     FADING: share of the velocities beside the rigid motion that goes a step and unit of strain; 0"""
import sys
import numpy as np
from scipy.spatial import Delaunay

FADING = float(sys.argv[1]) if len(sys.argv) > 1 else 0.0
POISSON, STEPS, MOST_FADING = 0.2, 1000, 0.3
LAMBDA, MU = POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), 0.5 / (1 + POISSON)  # of E = 1, with ρ = 1
random = np.random.default_rng(2)
grid = np.stack(np.meshgrid(*[np.arange(9.0)] * 3, indexing="ij"), -1).reshape(-1, 3)
points = grid + random.uniform(-0.3, 0.3, grid.shape)
mesh = Delaunay(points)
volumes = np.abs(np.linalg.det(points[mesh.simplices[:, 1:]] - points[mesh.simplices[:, :1]])) / 6
good = volumes > 0.03  # no slivers


def cut(size):
    """Tets that hang together by faces."""
    while True:
        found = [s for s in [random.integers(len(good))] if good[s]]
        for tet in found:
            found += [n for n in mesh.neighbors[tet] if n >= 0 and good[n] and n not in found][: size - len(found)]
        if len(found) == size:
            return mesh.simplices[found]


def build(size, count):
    """Of all pieces: nodes, tets, and the piece of each."""
    nodes, tets, total = [], [], 0
    for _ in range(count):
        used, numbers = np.unique(cut(size), return_inverse=True)
        nodes.append(points[used])
        tets.append(numbers.reshape(size, 4) + total)
        total += len(used)
    owner = np.repeat(np.arange(count), [len(n) for n in nodes])
    return np.concatenate(nodes), np.concatenate(tets), owner, np.repeat(np.arange(count), size)


def gradients(nodes, tets):
    x = nodes[tets]
    edges = (x[:, 1:] - x[:, :1]).transpose(0, 2, 1)
    inverse = np.linalg.inv(edges)
    return np.concatenate([-inverse.sum(1, keepdims=True), inverse], 1), np.abs(np.linalg.det(edges)) / 6


def stable_steps(slopes):
    """2/ω of each tet, with a quarter of its mass at each corner."""
    elastic = np.diag([2 * MU] * 3 + [MU] * 3)
    elastic[:3, :3] += LAMBDA
    b = np.zeros((len(slopes), 6, 12))
    for corner in range(4):
        g, k = slopes[:, corner], 3 * corner
        for i in range(3):
            b[:, i, k + i] = g[:, i]
            b[:, 3 + i, k + (i + 1) % 3], b[:, 3 + i, k + (i + 2) % 3] = g[:, (i + 2) % 3], g[:, (i + 1) % 3]
    return 2 / np.sqrt(np.linalg.eigvalsh(4 * np.einsum("nai,ab,nbj->nij", b, elastic, b))[:, -1])


def beside_rigid(velocity, position, mass, owner, count):
    total = np.bincount(owner, mass, count)
    mean = lambda q: np.stack([np.bincount(owner, mass * q[:, i], count) for i in range(3)], 1) / total[:, None]
    arm, rest = position - mean(position)[owner], velocity - mean(velocity)[owner]
    spin = mean(np.cross(arm, rest)) * total[:, None]
    inertia = np.zeros((count, 3, 3))
    for i in range(3):
        for j in range(3):
            part = (i == j) * (arm**2).sum(1) - arm[:, i] * arm[:, j]
            inertia[:, i, j] = np.bincount(owner, mass * part, count)
    lost = ~(np.abs(inertia).max((1, 2)) < 1e6) | ~np.isfinite(spin).all(1)  # what has gained without bound
    inertia[lost], spin[lost] = np.eye(3), 0
    return rest - np.cross(np.linalg.solve(inertia, spin[..., None])[..., 0][owner], arm)


def gaining(size, count, share, strain):
    """How many of the pieces gain half of their energy or more."""
    nodes, tets, owner, piece = build(size, count)
    slopes, volume = gradients(nodes, tets)
    smallest = np.full(count, np.inf)
    np.minimum.at(smallest, piece, stable_steps(slopes))
    step = share * smallest[owner][:, None]
    mass = np.bincount(tets.ravel(), np.repeat(volume / 4, 4), len(nodes))
    shift = random.normal(size=nodes.shape)
    square = np.bincount(piece, (np.einsum("nai,naj->nij", shift[tets], slopes) ** 2).sum((1, 2)), count) / size
    shift *= (strain / np.sqrt(square))[owner][:, None]
    velocity, energies = np.zeros_like(shift), []
    for _ in range(STEPS):
        f = np.eye(3) + np.einsum("nai,naj->nij", shift[tets], slopes)
        green = 0.5 * (np.einsum("nki,nkj->nij", f, f) - np.eye(3))
        trace = np.trace(green, axis1=1, axis2=2)
        stress = f @ (LAMBDA * trace[:, None, None] * np.eye(3) + 2 * MU * green)
        corner = -volume[:, None, None] * np.einsum("nij,naj->nai", stress, slopes)
        force = np.stack([np.bincount(tets.ravel(), corner[..., i].ravel(), len(nodes)) for i in range(3)], 1)
        before = velocity
        if FADING > 0:
            largest = np.zeros(count)
            np.maximum.at(largest, piece, np.sqrt((green**2).sum((1, 2))))
            faded = np.minimum(FADING * largest, MOST_FADING)[owner][:, None]
            before = velocity - faded * beside_rigid(velocity, nodes + shift, mass, owner, count)
        velocity = before + step * force / mass[:, None]
        strain_energy = np.bincount(piece, volume * (0.5 * LAMBDA * trace**2 + MU * (green**2).sum((1, 2))), count)
        energies.append(strain_energy + np.bincount(owner, 0.5 * mass * (before * velocity).sum(1), count))
        shift = shift + step * velocity
    energies = np.array(energies)
    return int((~(energies[-30:].max(0) < 1.5 * np.median(energies[:50], axis=0))).sum())


print("| tets a piece | pieces | strain at the start | step 0.80 of the stable one | 0.86 | 0.90 |\n|" + " --- |" * 6)
with np.errstate(all="ignore"):
    for size, count in ((1, 300), (2, 200), (4, 100), (16, 40), (100, 10)):
        for strain in (0.01, 0.02, 0.04):
            counts = (gaining(size, count, share, strain) for share in (0.80, 0.86, 0.90))
            print(f"| {size} | {count} | {100 * strain:.0f} % | " + " | ".join(f"{100 * n / count:.0f} %" for n in counts) + " |", flush=True)
