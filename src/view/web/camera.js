// Where the camera stands: around the middle of the mass over the frames of a time, and free obstacles near it, z up.
import * as THREE from 'three';

const SHARE = 0.02, SAMPLES = 24, MARGIN = 1.3; // mass that may be out of view on each side; frames looked at at most; room around it
const NOTHING = 1; // m in view where no piece is
const NEAR = 0.25; // how far a free obstacle may be from the pieces to be in view too, in diagonals of these

function percentile(entries, share) {
  entries.sort((a, b) => a[0] - b[0]);
  const total = entries.reduce((sum, e) => sum + e[1], 0);
  let sum = 0;
  for (const [value, mass] of entries) { sum += mass; if (sum >= share * total) return value; }
  return entries.length ? entries.at(-1)[0] : 0;
}

// Directions in which a line's outermost corners are kept: along the axes and the diagonals of space.
const WAYS = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [1, 1, -1], [1, -1, 1], [-1, 1, 1]].flatMap((way) => [way, way.map((c) => -c)]);

// Of every line, where in `corner` its outermost corners are.
function outermost(run) {
  const found = new Int32Array(run.count * WAYS.length);
  for (let line = 0; line < run.count; line++)
    WAYS.forEach(([x, y, z], way) => {
      let most = -Infinity;
      for (let i = 9 * run.begin[line]; i < 9 * run.begin[line + 1]; i += 3) {
        const reach = x * run.corner[i] + y * run.corner[i + 1] + z * run.corner[i + 2];
        if (reach > most) { most = reach; found[line * WAYS.length + way] = i; }
      }
    });
  return found;
}

// The camera's axes: to the right, up, and towards the viewer.
const TOWARD = new THREE.Vector3(0.42, -0.85, 0.36).normalize(), RIGHT = new THREE.Vector3(0, 0, 1).cross(TOWARD).normalize();
const AXES = [RIGHT, TOWARD.clone().cross(RIGHT), TOWARD];

// The frames from one time to another that are looked at.
function sampled(run, from, to) {
  const first = run.find(from).frame, last = run.find(to).frame, count = Math.min(SAMPLES, last - first + 1);
  return Array.from({ length: count }, (_, n) => first + Math.round(n * (last - first) / Math.max(1, count - 1)));
}

// Widens what is in view by the free obstacles that are near it and no larger, each where it is at a frame.
function includeObstacles(run, frame, low, high, near) {
  const pose = new THREE.Quaternion(), corner = new THREE.Vector3(), ends = [];
  run.obstacles.forEach((obstacle, i) => {
    if (obstacle.motion !== 'free') return;
    const at = 7 * (frame * run.obstacles.length + i);
    const box = AXES.map(() => [Infinity, -Infinity]);
    pose.fromArray(run.obstaclePose, at + 3);
    for (let n = 0; n < obstacle.positions.length; n += 3) {
      corner.fromArray(obstacle.positions, n).applyQuaternion(pose);
      corner.set(corner.x + run.obstaclePose[at], corner.y + run.obstaclePose[at + 1], corner.z + run.obstaclePose[at + 2]);
      box.forEach((end, k) => { const c = corner.dot(AXES[k]); end[0] = Math.min(end[0], c); end[1] = Math.max(end[1], c); });
    }
    if (box.every(([a, b], k) => b > near.low[k] - near.far && a < near.high[k] + near.far && b - a < 4 * near.far)) ends.push(box);
  });
  for (const box of ends) box.forEach(([a, b], k) => { low[k] = Math.min(low[k], a); high[k] = Math.max(high[k], b); });
}

export function frameOf(runs, from, to) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const run of runs) {
    const corners = outermost(run), entries = [[], [], []];
    const pose = new Float64Array(7), place = new THREE.Vector3(), turn = new THREE.Quaternion();
    for (const frame of sampled(run, from, to)) {
      for (let line = 0; line < run.count; line++) {
        if (run.carrierAt(frame, line) < 0) continue;
        run.pose({ frame, next: frame, share: 0 }, line, pose);
        const ends = [[Infinity, -Infinity], [Infinity, -Infinity], [Infinity, -Infinity]];
        for (let way = 0; way < WAYS.length; way++) {
          place.fromArray(run.corner, corners[line * WAYS.length + way]).applyQuaternion(turn.fromArray(pose, 3));
          place.set(place.x + pose[0], place.y + pose[1], place.z + pose[2]);
          ends.forEach((end, k) => { const at = place.dot(AXES[k]); end[0] = Math.min(end[0], at); end[1] = Math.max(end[1], at); });
        }
        for (let k = 0; k < 3; k++) for (const end of ends[k]) entries[k].push([end, run.fragment[run.leaf[line]].mass]);
      }
    }
    for (let k = 0; k < 3; k++) {
      low[k] = Math.min(low[k], percentile(entries[k], SHARE));
      high[k] = Math.max(high[k], percentile(entries[k], 1 - SHARE));
    }
  }
  if (!(Math.max(...high.map((h, k) => h - low[k])) > 0)) for (let k = 0; k < 3; k++) { low[k] -= NOTHING / 2; high[k] += NOTHING / 2; } // no piece is there
  const near = { low: [...low], high: [...high], far: NEAR * Math.hypot(...low.map((l, k) => high[k] - l)) };
  for (const run of runs) for (const frame of sampled(run, from, to)) includeObstacles(run, frame, low, high, near);
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
