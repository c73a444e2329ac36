// three.js's own reader of USD, which knows nothing of who wrote it: bodies are where the run file has them at three frames.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const [folder, source] = process.argv.slice(2);
const from = (path) => import(pathToFileURL(`${source}/src/view/web/node_modules/three/${path}`));
const { USDLoader } = await from('examples/jsm/loaders/USDLoader.js');
const { AnimationMixer, Box3, Vector3 } = await from('build/three.module.js');
const judge = JSON.parse(readFileSync(`${folder}/judge.json`));
const NEAR = 2e-6, ROUND = 1e-4; // m: floats, interpolated at float times; a ball of triangles is no ball
const problems = [];
function check(condition, message) { if (!condition) problems.push(message); }

const text = readFileSync(`${folder}/run.usda`, 'utf8'), scene = new USDLoader().parse(text);
const head = (name) => Number(new RegExp(`^    ${name} = (\\S+)$`, 'm').exec(text)?.[1]);
const rate = head('timeCodesPerSecond'), frames = Object.keys(judge.corners).map(Number);
check(head('metersPerUnit') === 1 && /^    upAxis = "Z"$/m.test(text), 'other units or axes');
check(Math.abs(head('startTimeCode') / rate - judge.times[0]) < 1e-9 && Math.abs(head('endTimeCode') / rate - judge.times.at(-1)) < 1e-9, 'begins or ends at other times');
scene.rotation.set(0, 0, 0); // the reader turns z up to y up
const bodies = new Map();
scene.traverse((node) => { if (/^(line|obstacle)_\d+$/.test(node.name)) bodies.set(node.name, node); });
const parents = new Set(judge.fragments.map((f) => f.parent));
const leaves = judge.fragments.map((f, i) => [i, `line_${f.line}`]).filter(([i]) => !parents.has(i));
check(leaves.length + judge.obstacles.length === bodies.size, `${bodies.size} bodies for ${leaves.length} lines and ${judge.obstacles.length} obstacles`);

function rotate([w, x, y, z], v) {
  const axis = new Vector3(x, y, z), across = axis.clone().cross(v).multiplyScalar(2);
  return v.clone().addScaledVector(across, w).add(axis.cross(across));
}
const vector = (numbers) => new Vector3(...numbers);

// Where a fragment's centre is: it moves with the ancestor that lives; and the run file's corners of its line there.
function expected(leaf, name, pieces) {
  let carrier = leaf;
  while (!pieces[carrier]) carrier = judge.fragments[carrier].parent;
  const [place, turn] = pieces[carrier];
  const arm = vector(judge.fragments[leaf].pivot).sub(vector(judge.fragments[carrier].pivot));
  const centre = vector(place).add(rotate(turn, arm)), box = new Box3();
  for (const corner of judge.shapes[name]) box.expandByPoint(rotate(turn, vector(corner)).add(centre));
  return { centre, box };
}

const off = (a, b) => Math.max(...a.clone().sub(b).toArray().map(Math.abs));
function compare(name, frame, centre, box, near) {
  const node = bodies.get(name), seen = new Vector3().setFromMatrixPosition(node.matrixWorld), reach = new Box3().setFromObject(node, true);
  check(off(seen, centre) < NEAR, `${name} is at ${seen.toArray()}, not ${centre.toArray()}, in frame ${frame}`);
  check(!box || Math.max(off(reach.min, box.min), off(reach.max, box.max)) < near, `${name} reaches elsewhere in frame ${frame}`);
}

const mixer = new AnimationMixer(scene);
for (const clip of scene.animations) mixer.clipAction(clip).play();
for (const frame of frames) {
  // Of one loop: its end is its beginning, so the last frame is read from just before it.
  mixer.setTime(Math.min(judge.times[frame], scene.animations[0].duration * (1 - 1e-7)));
  scene.updateMatrixWorld(true);
  for (const [leaf, name] of leaves) {
    const { centre, box } = expected(leaf, name, judge.pieces[frame]);
    compare(name, frame, centre, box, NEAR);
  }
  judge.obstacles.forEach(({ shape, radius, size }, i) => {
    const [place] = judge.obstacle_poses[frame][i], half = shape === 'sphere' ? [radius, radius, radius] : size.map((s) => s / 2);
    const box = shape === 'plane' ? null : new Box3(vector(place).sub(vector(half)), vector(place).add(vector(half)));
    compare(`obstacle_${i}`, frame, vector(place), box, ROUND);
  });
}
if (problems.length) { console.error(`USD: ${problems.slice(0, 10).join('\n')}`); process.exit(1); }
console.log(`as in the run file: ${leaves.length} lines and ${judge.obstacles.length} obstacles at three frames`);
