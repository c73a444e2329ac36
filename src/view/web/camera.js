// Where the camera stands: around the middle of the mass over all frames, z up.
import * as THREE from 'three';

const SHARE = 0.03, FRAMES = 24, MARGIN = 1.25; // mass that may be out of view on each side; frames looked at; room around it

function percentile(entries, share) {
  entries.sort((a, b) => a[0] - b[0]);
  const total = entries.reduce((sum, e) => sum + e[1], 0);
  let sum = 0;
  for (const [value, mass] of entries) { sum += mass; if (sum >= share * total) return value; }
  return entries.length ? entries.at(-1)[0] : 0;
}

// Largest distance of a line's corners from its centre.
function radii(run) {
  const radius = new Float64Array(run.count);
  for (let line = 0; line < run.count; line++)
    for (let i = 9 * run.begin[line]; i < 9 * run.begin[line + 1]; i += 3)
      radius[line] = Math.max(radius[line], Math.hypot(run.corner[i], run.corner[i + 1], run.corner[i + 2]));
  return radius;
}

// The camera's axes: to the right, up, and towards the viewer.
const TOWARD = new THREE.Vector3(0.42, -0.85, 0.36).normalize(), RIGHT = new THREE.Vector3(0, 0, 1).cross(TOWARD).normalize();
const AXES = [RIGHT, TOWARD.clone().cross(RIGHT), TOWARD];

export function frameOf(runs) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const run of runs) {
    const radius = radii(run), entries = [[], [], []];
    const pose = new Float64Array(7), place = new THREE.Vector3();
    for (let n = 0; n < FRAMES; n++) {
      const frame = Math.round(n * (run.frames - 1) / (FRAMES - 1));
      for (let line = 0; line < run.count; line++) {
        if (run.carrierAt(frame, line) < 0) continue;
        run.pose({ frame, next: frame, share: 0 }, line, pose);
        place.set(pose[0], pose[1], pose[2]);
        for (let k = 0; k < 3; k++)
          for (const side of [-0.6, 0.6]) entries[k].push([place.dot(AXES[k]) + side * radius[line], run.fragment[run.leaf[line]].mass]);
      }
    }
    for (let k = 0; k < 3; k++) {
      low[k] = Math.min(low[k], percentile(entries[k], SHARE));
      high[k] = Math.max(high[k], percentile(entries[k], 1 - SHARE));
    }
  }
  const centre = new THREE.Vector3(), half = low.map((l, k) => (high[k] - l) / 2);
  AXES.forEach((axis, k) => centre.addScaledVector(axis, (low[k] + high[k]) / 2));
  return { centre: centre.toArray(), half, reach: Math.max(1e-6, Math.hypot(...half)) };
}

export function place(camera, controls, view, aspect) {
  const tangent = Math.tan(camera.fov * Math.PI / 360);
  const distance = MARGIN * Math.max(view.half[1] / tangent, view.half[0] / (tangent * aspect)) + view.half[2];
  camera.up.set(0, 0, 1);
  camera.position.set(...view.centre).addScaledVector(TOWARD, distance);
  camera.near = view.reach / 200;
  camera.far = view.reach * 60;
  controls.target.set(...view.centre);
  controls.update();
}
