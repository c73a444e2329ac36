// Where the camera stands: around the middle of the mass over all frames, z up.
import * as THREE from 'three';

const SHARE = 0.05, FRAMES = 24; // mass that may be out of view on each side; frames looked at

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

export function frameOf(runs) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const run of runs) {
    const radius = radii(run), entries = [[], [], []];
    const pose = new Float64Array(7);
    for (let n = 0; n < FRAMES; n++) {
      const frame = Math.round(n * (run.frames - 1) / (FRAMES - 1));
      for (let line = 0; line < run.count; line++) {
        if (run.carrierAt(frame, line) < 0) continue;
        run.pose({ frame, next: frame, share: 0 }, line, pose);
        for (let k = 0; k < 3; k++)
          for (const side of [-0.8, 0.8]) entries[k].push([pose[k] + side * radius[line], run.fragment[run.leaf[line]].mass]);
      }
    }
    for (let k = 0; k < 3; k++) {
      low[k] = Math.min(low[k], percentile(entries[k], SHARE));
      high[k] = Math.max(high[k], percentile(entries[k], 1 - SHARE));
    }
  }
  const centre = low.map((l, k) => (l + high[k]) / 2);
  return { centre, reach: Math.max(1e-6, Math.hypot(...low.map((l, k) => high[k] - l)) / 2), half: low.map((l, k) => (high[k] - l) / 2) };
}

export function place(camera, controls, view, aspect) {
  const toward = new THREE.Vector3(0.42, -0.85, 0.36).normalize(), right = new THREE.Vector3(0, 0, 1).cross(toward).normalize(), up = toward.clone().cross(right);
  const along = (axis) => Math.abs(axis.x) * view.half[0] + Math.abs(axis.y) * view.half[1] + Math.abs(axis.z) * view.half[2];
  const tangent = Math.tan(camera.fov * Math.PI / 360);
  const distance = 1.04 * Math.max(along(up) / tangent, along(right) / (tangent * aspect)) + along(toward);
  camera.up.set(0, 0, 1);
  camera.position.set(...view.centre).addScaledVector(toward, distance);
  camera.near = view.reach / 200;
  camera.far = view.reach * 60;
  controls.target.set(...view.centre);
  controls.update();
}
