#!/usr/bin/env python3
"""Slit strips of glass on unstructured meshes of gmsh, against Griffith's load.

usage: strips.py PROGRAM FOLDER [EDGES [MESHES [SLITS]]]      for example  strips.py shiver strips 4,2 3 edge,half,centre,layers
       strips.py griffith
       strips.py least RUN.h5 NEAR AREA      smallest area of facets that part the mesh between x = -NEAR and NEAR, over AREA (mm, mm²)

Griffith's load is that of a plane model of its own: the energy that squares of 1 and 0.5 mm release as the slit grows by two of them,
extrapolated to none. Each next mesh has edges 2 % shorter. The table has the largest nominal stress until two edges at each tip have
failed over Griffith's, areas over that of the ligament, and the energy of fracture over G × ligament. Facets lean: "failed" is their own
area and "plane" what they cover of the crack's plane; "least" is the smallest area of facets that part the mesh from slit to edge (a
maximum flow through its tets), and no crack along facets has less. Takes gmsh, python3-h5py, python3-scipy.
"""
import json
import os
import subprocess
import sys

import h5py
import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import maximum_flow
from scipy.sparse.linalg import spsolve

FOLDER = os.path.dirname(os.path.abspath(__file__))
MODULUS, POISSON, ENERGY = 70e9, 0.2, 8.0
LENGTH, WIDTH = 80.0, 40.0  # mm
REACTION = 15  # its x among the numbers of a probe, docs/run_file.md
SLITS = {  # from and to, mm from the middle; edges through the thickness; plane strain; tips
    "edge": (-20.0, -10.0, 2, True, 1),
    "half": (-20.0, 0.0, 2, True, 1),
    "centre": (-10.0, 10.0, 2, True, 2),
    "layers": (-10.0, 10.0, 3, False, 2),
}


def stiffness_of_square(plane_strain):
    modulus = MODULUS / (1 - POISSON**2) if plane_strain else MODULUS
    ratio = POISSON / (1 - POISSON) if plane_strain else POISSON
    law = modulus / (1 - ratio**2) * np.array([[1, ratio, 0], [ratio, 1, 0], [0, 0, (1 - ratio) / 2]])
    sum_of_points = np.zeros((8, 8))
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    for x in (-(3**-0.5), 3**-0.5):
        for y in (-(3**-0.5), 3**-0.5):
            slope = np.array([corners[:, 0] * (1 + corners[:, 1] * y), corners[:, 1] * (1 + corners[:, 0] * x)]) / 4
            strain = np.zeros((3, 8))
            strain[0, 0::2], strain[1, 1::2] = slope[0], slope[1]
            strain[2, 0::2], strain[2, 1::2] = slope[1], slope[0]
            sum_of_points += strain.T @ law @ strain  # of squares: the size of one cancels
    return sum_of_points


def energy_and_load(start, end, plane_strain, square, displacement=1e-6):
    """Of the half right of the slit, J/m and N/m, its far end moved by `displacement`."""
    columns, rows = int(LENGTH / 2 / square), int(WIDTH / square)
    node = np.arange((columns + 1) * (rows + 1)).reshape(columns + 1, rows + 1)
    corners = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], -1).reshape(-1, 4)
    freedoms = np.stack([2 * corners, 2 * corners + 1], -1).reshape(-1, 8)
    values = np.tile(stiffness_of_square(plane_strain).ravel(), len(freedoms))
    matrix = coo_matrix((values, (np.repeat(freedoms, 8, 1).ravel(), np.tile(freedoms, (1, 8)).ravel()))).tocsr()
    height = -WIDTH / 2 + square * np.arange(rows + 1)
    held = node[0][(height <= start + 1e-9) | (height >= end - 1e-9)] if start > -WIDTH / 2 else node[0][height >= end - 1e-9]
    u = np.zeros(2 * node.size)
    u[2 * node[-1]] = displacement
    fixed = np.concatenate([2 * held, 2 * node[-1], [2 * node[-1, rows // 2] + 1]])
    free = np.setdiff1d(np.arange(u.size), fixed)
    u[free] = spsolve(matrix[free][:, free].tocsc(), -(matrix @ u)[free])
    force = matrix @ u
    return 0.5 * u @ force, force[2 * node[-1]].sum()


def load_of_growth(start, end, plane_strain, tips, square):
    """Nominal stress at which the slit grows at its tips, Pa."""
    grow = square if tips == 2 else 0.0
    more, _ = energy_and_load(start - grow, end + square, plane_strain, square)
    less, _ = energy_and_load(start + grow, end - square, plane_strain, square)
    _, load = energy_and_load(start, end, plane_strain, square)
    released = 2 * (less - more) / (2 * square * 1e-3 * tips)  # of both halves, J/m²
    return load / (WIDTH * 1e-3) * (ENERGY / released) ** 0.5


def griffith(name):
    start, end, _, plane_strain, tips = SLITS[name]
    return 2 * load_of_growth(start, end, plane_strain, tips, 0.5) - load_of_growth(start, end, plane_strain, tips, 1.0)


def least_cut(nodes, tets, near):
    """Smallest area of facets that part what lies left of x = -near from what lies right of it, m²; slits are apart already."""
    faces = np.sort(np.concatenate([tets[:, [1, 2, 3]], tets[:, [0, 2, 3]], tets[:, [0, 1, 3]], tets[:, [0, 1, 2]]]), 1)
    order = np.lexsort(faces.T[::-1])
    faces, owner = faces[order], np.tile(np.arange(len(tets)), 4)[order]
    shared = np.flatnonzero((faces[1:] == faces[:-1]).all(1))
    first, second = owner[shared], owner[shared + 1]
    corner = nodes[faces[shared]]
    area = 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    x = nodes[tets, 0].mean(1)
    left, right, count = np.flatnonzero(x < -near), np.flatnonzero(x > near), len(tets)
    quantum = 2e-12  # m²: flows are whole numbers of 32 bits
    sides = np.full(len(left) + len(right), 2**31 - 1)
    flow = np.concatenate([area / quantum, area / quantum, sides]).astype(np.int32)
    start = np.concatenate([first, second, np.full(len(left), count), right])
    end = np.concatenate([second, first, left, np.full(len(right), count + 1)])
    network = csr_matrix((flow, (start, end)), shape=(count + 2, count + 2))
    return maximum_flow(network, count, count + 1).flow_value * quantum


def run(program, folder, name, edge, mesh):
    start, end, layers, plane_strain, tips = SLITS[name]
    thickness = layers * edge
    path = os.path.abspath(os.path.join(folder, f"{name}_{edge:g}_{mesh}"))
    numbers = {"edge": edge * 0.98**mesh, "thickness": thickness, "from": start, "to": end}
    subprocess.run(["gmsh", "-0", "-nt", "1", "-v", "0", "-format", "msh41", "-bin"]
                   + [word for key, value in numbers.items() for word in ("-setnumber", key, str(value))]
                   + [os.path.join(FOLDER, "strip.geo"), "-o", path + ".msh"], check=True)
    changes = [f"objects.strip.mesh.gmsh.file={path}.msh", f"imposed_velocities.back.on.plane.offset={thickness * 1e-3}"]
    if not plane_strain:  # held for no time
        changes += ["imposed_velocities.front.end=1e-12", "imposed_velocities.back.end=1e-12"]
    text = subprocess.run([program, "run", os.path.join(FOLDER, "strip.yaml"), "--json", "--force", "--output", path + ".h5"]
                          + [word for change in changes for word in ("--set", change)],
                          check=True, capture_output=True, text=True).stdout
    with h5py.File(path + ".h5") as file:
        least = least_cut(file["mesh/positions"][()], file["mesh/elements"][()], 4e-3 + edge * 1e-3)
        failed, time = file["ledger"]["failed_area"], file["trajectory/time"][()]
        covered = file["ledger"]["fracture_energy_area"][-1] / ENERGY
        grown = failed >= 2 * edge * tips * thickness * 1e-6
        until = file["probes/time"][()] <= (time[grown][0] if grown.any() else time[-1])
        load = np.nanmax(abs(file["probes/samples"][:, 0, REACTION][until]))
    end = json.loads(text)
    ligament = (WIDTH - SLITS[name][1] + SLITS[name][0]) * thickness * 1e-6
    areas = np.array([end["inserted_area"], end["failed_area"], least, covered, end["fracture_dissipation"] / ENERGY]) / ligament
    return load / (WIDTH * thickness * 1e-6) / griffith(name), *areas, end["fragments"], end["wall_seconds"]


def main(program, folder, edges="4,2", meshes="3", slits="edge,half,centre,layers"):
    os.makedirs(folder, exist_ok=True)
    print("slit     edge  mesh   load   inserted  failed  least  plane  dissipation  pieces  seconds")
    for name in slits.split(","):
        for edge in edges.split(","):
            for mesh in range(int(meshes)):
                row = run(program, folder, name, float(edge), mesh)
                numbers = (f"{value:{width}}" for value, width in zip(row, ("6.2f", "9.2f", "7.2f", "6.2f", "6.2f", "12.2f", "7d", "8.0f")))
                print(f"{name:8s} {edge:>4s} {mesh:5d}", *numbers, flush=True)


if sys.argv[1] == "griffith":
    for slit in SLITS:
        print(f"{slit:8s} {griffith(slit) / 1e6:.3f} MPa")
elif sys.argv[1] == "least":
    with h5py.File(sys.argv[2]) as file:
        area = least_cut(file["mesh/positions"][()], file["mesh/elements"][()], float(sys.argv[3]) * 1e-3)
    print(f"{area * 1e6 / float(sys.argv[4]):.3f}")
else:
    main(*sys.argv[1:])
