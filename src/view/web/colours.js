// Colours of pieces. Those by line are those of `shiver export svg`: they follow the line, and the heaviest piece is of stone.
import { figure } from './units.js';

const LINES = [0xd1495b, 0xedae49, 0x2a8fa3, 0x6aa58f, 0x9a73a3, 0xf4845f, 0x4f7fb8, 0xa9c777, 0xcf7fa4, 0x86b3d9, 0xe3c567, 0x4fa37a];
const STONE = 0xd9d1c2, FLIGHT = 0x7f9fb8, FRACTURE = 0xf0803c;
const rgb = (hex) => [(hex >> 16 & 255) / 255, (hex >> 8 & 255) / 255, (hex & 255) / 255];
const RAMP = [0x31446b, 0x2f7f93, 0x56b08a, 0xc9cf66, 0xf6d746].map(rgb);
const HEAT = [0xcfc9bd, 0xe8b26a, 0xe2713f, 0xb32d3a, 0x6b1338].map(rgb);

export function along(ramp, share) {
  const place = Math.min(1, Math.max(0, share)) * (ramp.length - 1), i = Math.min(ramp.length - 2, Math.floor(place)), t = place - i;
  return ramp[i].map((c, k) => c + t * (ramp[i + 1][k] - c));
}
export const heat = (share) => along(HEAT, share);

const css = (c) => `rgb(${c.map((v) => Math.round(255 * v)).join(',')})`;
const ramp = (colours, low, high) => ({ ramp: `linear-gradient(90deg,${colours.map(css).join(',')})`, low, high });

export const lineColour = (line) => rgb(LINES[((Math.imul(line, -1640531527) >>> 0) >>> 16) % LINES.length]);

function heaviest(run, frame) {
  let best = -1;
  for (let i = 0; i < run.count; i++) {
    const c = run.carrierAt(frame, i);
    if (c >= 0 && (best < 0 || run.fragment[c].mass > run.fragment[best].mass)) best = c;
  }
  return best;
}

// Fastest that is common: the 95th percentile of each frame, the largest of all frames.
function commonSpeed(run) {
  let most = 1e-9;
  for (let f = 0; f < run.frames; f += Math.ceil(run.frames / 60)) {
    const speeds = [];
    for (let i = 0; i < run.count; i++) if (run.carrierAt(f, i) >= 0) speeds.push(Math.hypot(...run.velocity(f, i)));
    speeds.sort((a, b) => a - b);
    if (speeds.length) most = Math.max(most, speeds[Math.floor(0.95 * (speeds.length - 1))]);
  }
  return most;
}

// By name: `prepare` looks at the runs once, `colour` gives the colour of a line at a frame, `face` names a byte of faces instead.
export const CHOICES = {
  piece: { prepare: () => ({}), begin: (run, at) => heaviest(run, at.frame), colour: (_, run, at, c, __, best) => (c === best ? rgb(STONE) : lineColour(run.fragment[c].line)) },
  mode: {
    prepare: () => ({ keys: [['flight', css(rgb(FLIGHT))], ['fracture', css(rgb(FRACTURE))]] }),
    colour: (_, run, at, c, line) => rgb(run.awakeAt(at.frame, line) ? FRACTURE : FLIGHT),
  },
  age: {
    prepare: (runs) => {
      const births = runs.flatMap((r) => r.fragment.map((f) => f.birth)), end = Math.max(...runs.map((r) => r.time.at(-1)));
      const first = Math.min(...births.filter((b) => b > Math.min(...births)), end);
      const most = Math.max(1e-12, end - first);
      return { most, ...ramp(RAMP, 'new', figure(most, 's', 3)) };
    },
    colour: (s, run, at, c) => along(RAMP, (at.time - run.fragment[c].birth) / s.most),
  },
  speed: {
    prepare: (runs) => { const most = Math.max(...runs.map(commonSpeed)); return { most, ...ramp(RAMP, '0', figure(most, 'm/s', 3)) }; },
    colour: (s, run, at, c, line) => along(RAMP, Math.hypot(...run.velocity(at.frame, line)) / s.most),
  },
  mass: {
    prepare: (runs) => {
      const masses = runs.flatMap((r) => r.fragment.map((f) => f.mass)).filter((m) => m > 0);
      const low = Math.log(Math.min(...masses)), high = Math.log(Math.max(...masses));
      return { low, span: Math.max(1e-9, high - low), ...ramp(RAMP, figure(1e3 * Math.exp(low), 'g', 3), figure(1e3 * Math.exp(high), 'g', 3)), lowMass: low };
    },
    colour: (s, run, at, c) => along(RAMP, (Math.log(run.fragment[c].mass) - s.lowMass) / s.span),
  },
  damage: { face: 0, has: (run) => run.shapes, prepare: () => ramp(HEAT, '0', '1') },
  stress: { face: 1, has: (run) => run.shapes && run.head.stress > 0, prepare: (runs) => ({ title: 'largest tension, root scale', ...ramp(HEAT, '0', figure(Math.max(...runs.map((r) => r.head.stress)), 'Pa', 3)) }) },
};
