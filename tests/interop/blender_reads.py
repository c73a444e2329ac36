"""Blender: the .glb has a node a line, at the run's places and turns at three frames, and the obstacles."""
import collections
import os
import sys

import numpy

if not hasattr(numpy, "bool"):
    numpy.bool = bool  # Blender 3.4's importer names what NumPy 1.24 has removed
import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import tables

folder = os.path.abspath(sys.argv[sys.argv.index("--") + 1])
judge = tables.Judge(folder)
RATE = 500  # frames a second, as in scene.yaml: frames are whole numbers
NEAR = 2e-6  # m: floats, interpolated at float times
ROUND = 1e-4  # m: a ball of triangles is no ball

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = RATE
bpy.ops.import_scene.gltf(filepath=f"{folder}/run.glb")
bodies = {o.name: o for o in bpy.data.objects}
lines = {name: o for name, o in bodies.items() if name.startswith("line_")}
obstacles = {o["obstacle"]: o for n, o in bodies.items() if n.startswith("obstacle_")}


def check(condition, message):
    if not condition:
        print(f"Blender: {message}")
        sys.exit(1)


def corners(node):
    """In the world: the importer turns shapes from y up to z up, so its nodes have other axes."""
    return [node.matrix_world @ vertex.co for vertex in node.data.vertices]


def open_edges(node):
    """Edges that not two faces have, or four where a piece touches itself: what Blender's booleans and rigid bodies stumble over."""
    uses = collections.Counter(key for polygon in node.data.polygons for key in polygon.edge_keys)
    return sum(count % 2 for count in uses.values())


check(set(lines) == set(judge.leaves), f"{len(lines)} lines for {len(judge.leaves)} last pieces")
for name, node in lines.items():
    check(open_edges(node) == 0, f"{name} is not closed: {open_edges(node)} edges")
    check(not any(polygon.use_smooth for polygon in node.data.polygons), f"{name} is shaded smooth")
check(sorted(obstacles) == sorted(o["name"] for o in judge.obstacles), "other obstacles")
for frame in judge.three:
    time = judge.times[frame]
    bpy.context.scene.frame_set(int(time * RATE + 1e-6), subframe=0.0)
    for name, leaf in judge.leaves.items():
        node = lines[name]
        check(node["fragment"] == leaf, f"{name} ends with {node['fragment']}, not {leaf}")
        there, place = tuple(node.matrix_world.to_translation()), judge.body(leaf, frame)[0]
        check(tables.apart(there, place) < NEAR, f"{name} is at {there}, not {place}, at {time}")
        seen, wanted = tables.reach(corners(node)), tables.reach(judge.moved(name, frame))
        check(tables.apart(seen, wanted) < NEAR, f"{name} reaches to {seen}, not {wanted}, at {time}")
    for number, obstacle in enumerate(judge.obstacles):
        node, place = obstacles[obstacle["name"]], judge.obstacle_poses[frame][number][0]
        there, wanted = tuple(node.matrix_world.to_translation()), judge.obstacle_reach(number, frame)
        check(tables.apart(there, place) < NEAR, f"{node.name} is at {there}, not {place}, at {time}")
        check(wanted is None or tables.apart(tables.reach(corners(node)), wanted) < ROUND, f"{node.name} has another size at {time}")
print(f"as in the run file: {len(lines)} lines at three frames, {len(obstacles)} obstacles")
