"""A plate lies on two bars; in mid-run a steel ball is thrown at it, and its splits come as events. Bad arrays are refused in words."""
import os
import tempfile

import numpy as np
import shiver

SCENE = """
shiver: 1
materials:
  plaster: {library: plaster}
objects:
  plate: {mesh: {memory: {scale: 1}}, material: plaster, position: [0, 0, 0.02]}
obstacles:
  left: {box: {size: [0.02, 0.3, 0.02]}, position: [-0.08, 0, 0.01]}
  right: {box: {size: [0.02, 0.3, 0.02]}, position: [0.08, 0, 0.01]}
  floor: {plane: {normal: [0, 0, 1]}}
  ball: {sphere: {radius: 0.02}, mass: 0.26, waits: true}
duration: 0.02
"""


def bricks(cells, size):
    """Bricks of five tets, mirrored from one to the next."""
    n = np.array(cells) + 1
    index = np.arange(n.prod()).reshape(n[::-1])
    z, y, x = np.meshgrid(*(np.arange(k) for k in n[::-1]), indexing="ij")
    positions = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1) * (np.array(size) / cells) - np.array(size) / 2 * [1, 1, 0]
    tets = []
    for k in range(cells[2]):
        for j in range(cells[1]):
            for i in range(cells[0]):
                corner = index[k:k + 2, j:j + 2, i:i + 2]
                if (i + j + k) % 2:
                    corner = corner[:, :, ::-1]
                c = corner.ravel()
                five = np.array([[0, 1, 3, 5], [0, 3, 2, 6], [0, 5, 6, 4], [3, 6, 5, 7], [0, 3, 6, 5]])
                tets += list(c[five if not (i + j + k) % 2 else five[:, [0, 1, 3, 2]]])
    return positions, np.array(tets)


def refused(kind, text, call):
    try:
        call()
    except kind as error:
        assert text in str(error), str(error)
        return
    raise AssertionError(f"not refused: {text}")


positions, tets = bricks((8, 8, 1), (0.2, 0.2, 0.01))
scene = shiver.Scene(text=SCENE)
refused(ValueError, "(n, 3)", lambda: scene.give_mesh("plate", positions.T, tets))
refused(TypeError, "int32", lambda: scene.give_mesh("plate", positions, tets.astype(float)))
refused(shiver.Error, "no object 'cup'", lambda: scene.give_mesh("cup", positions, tets))
refused(shiver.Error, "from memory has 0 nodes", lambda: shiver.Simulation(scene))
scene.give_mesh("plate", positions, tets)

simulation = shiver.Simulation(scene)
events = []
simulation.on_event = events.append
simulation.step(0.01)
refused(shiver.Error, "would stand in the object 'plate'", lambda: simulation.enter("ball", (0, 0, 0.025)))
refused(ValueError, "three numbers", lambda: simulation.enter("ball", (0, 0)))
simulation.enter("ball", (0, 0, 0.06), velocity=(0, 0, -6))
while not any(event["kind"] == "split" for event in events) and simulation.time < 0.02:
    simulation.step(simulation.time + 1e-3)
split = [event for event in events if event["kind"] == "split"]
alive = simulation.fragments["mode"] < shiver.DEAD
assert split and alive.sum() > 1, events
assert abs(simulation.obstacles["ball"]["velocity"][2]) < 6
assert np.isclose(simulation.fragments["mass"][alive].sum(), simulation.fragments["mass"][0])
assert abs(simulation.ledger["residual"]) < 0.01 * simulation.ledger["largest"]
simulation.leave("ball")
assert simulation.corners.shape == (len(tets), 4, 3)
print(f"shiver {shiver.version()}: at {split[0]['time']:.4f} s the plate came apart, {alive.sum()} pieces at {simulation.time:.3f} s")

# A body that flies freely, pushed at its centre: Newton's law.
text = "shiver: 1\nmaterials: {s: {library: steel}}\nobjects: {b: {mesh: {ball: {radius: 0.1, edge: 0.05}}, material: s}}\nduration: 1\n"
free = shiver.Simulation(shiver.Scene(text=text, settings={"gravity": [0, 0, 0]}))
free.push(0, (3, 0, 0))
free.step(0.5)
body = free.fragments[0]
assert np.allclose(body["velocity"], [3 / body["mass"], 0, 0]) and np.allclose(body["position"], [1.5 / body["mass"], 0, 0], atol=1e-12)

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "fall.h5")
    run = shiver.run(shiver.Scene(text=text, settings={"duration": 0.1, "output.rate": 20}), path)
    assert run.info["status"] == "finished" and np.allclose(run.times, [0, 0.05, 0.1])
    assert np.isclose(run.frame(-1)["position"][0, 2], -9.81 * 0.1**2 / 2) and run.objects == ["b"]
    assert len(run.mesh[1]) == run.fragments["tets"][0] and run.ledger(0)["kinetic"] == 0
    refused(shiver.Error, "fall.h5", lambda: shiver.run(shiver.Scene(text=text), path))
