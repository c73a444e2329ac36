"""Blender: the .glb has a node a line, at the run's places and turns at three frames, and the obstacles."""
import os
import sys

import numpy

if not hasattr(numpy, "bool"):
    numpy.bool = bool  # Blender 3.4's importer names what NumPy 1.24 has removed
import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import tables

folder = os.path.abspath(sys.argv[sys.argv.index("--") + 1])
judge = tables.frames(folder)
family = tables.genealogy(folder)
shapes = tables.shapes(folder)
times = sorted(judge)
RATE = 500  # frames a second, as in scene.yaml: frames are whole numbers
NEAR = 2e-6  # m: floats, interpolated at float times

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = RATE
bpy.ops.import_scene.gltf(filepath=f"{folder}/run.glb")
bodies = {o.name: o for o in bpy.data.objects}
lines = {name: o for name, o in bodies.items() if name.startswith("line_")}
parents = {int(row["parent"]) for row in family.values()}
leaves = [i for i in family if i not in parents]


def check(condition, message):
    if not condition:
        print(f"Blender: {message}")
        sys.exit(1)


check(len(lines) == len(leaves), f"{len(lines)} lines for {len(leaves)} last pieces")
check(sorted(o["obstacle"] for n, o in bodies.items() if n.startswith("obstacle_")) == ["ball", "floor", "step"], "other obstacles")
for time in (times[0], times[len(times) // 2], times[-1]):
    frame = time * RATE
    bpy.context.scene.frame_set(int(frame + 1e-6), subframe=0.0)
    for leaf in leaves:
        node = lines[f"line_{family[leaf]['line']}"]
        check(node["fragment"] == leaf, f"{node.name} ends with {node['fragment']}, not {leaf}")
        place, turn = tables.body(folder, judge[time], leaf, family)
        matrix = node.matrix_world
        seen = matrix.to_translation()
        check(max(abs(a - b) for a, b in zip(seen, place)) < NEAR, f"{node.name} is at {tuple(seen)}, not {place}, at {time}")
        # The importer turns shapes from y up to z up, so its nodes have other axes: corners tell what they do.
        corners = [matrix @ vertex.co for vertex in node.data.vertices]
        wanted = [[p + c for p, c in zip(place, tables.rotate(turn, corner))] for corner in shapes[f"line_{family[leaf]['line']}"]]
        for k in range(3):
            for side in (min, max):
                a, b = side(c[k] for c in corners), side(c[k] for c in wanted)
                check(abs(a - b) < NEAR, f"{node.name} reaches to {a}, not {b}, at {time}")
print(f"as in the run file: {len(lines)} lines at three frames, 3 obstacles")
