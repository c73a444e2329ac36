// Ledger, pieces and cost over time, tied to the clock.
import uPlot from 'uplot';
import { figure } from './units.js';

const COLOURS = ['#4f7fb8', '#d1495b', '#edae49', '#2a8fa3', '#9a73a3', '#6aa58f', '#f4845f', '#8d877b'];
const DASHES = [undefined, [5, 4]];
const negated = (values) => values.map((v) => 0 - v);
const fallen = (values) => { const low = Math.min(...values); return values.map((v) => v - low); };

// What may be drawn: name and values; what stays zero is left out.
function energies(run) {
  const c = run.curve;
  return [['kinetic', c.kinetic], ['height', fallen(c.gravity_potential)], ['strain', c.strain], ['fracture', c.fracture_dissipation],
    ['contact', negated(c.contact)], ['friction', negated(c.friction)], ['closing cracks', negated(c.closure)], ['damping', negated(c.damping)]];
}
const pieces = (run) => [['pieces', run.curve.alive], ['facets inserted', run.curve.inserted], ['failed', run.curve.failed]];
function costs(run) {
  const parts = run.head.costs.map((name) => [name, run.curve['cost ' + name]]).sort((a, b) => b[1].at(-1) - a[1].at(-1)).slice(0, 4);
  return [['all', run.curve.wall], ...parts];
}

// Name: what is drawn, unit, and how many of the curves have the left scale (the rest have the right one).
const KINDS = { energy: [energies, 'J', 99], count: [pieces, '', 1], cost: [costs, 's', 99] };

class Curve {
  constructor(element, runs, kind, clock, seek) {
    const [of, unit, left] = KINDS[kind];
    Object.assign(this, { element, runs, clock, seek, unit, left });
    const all = runs.map(of), most = Math.max(...all.flat().map(([, v]) => Math.max(...v.map(Math.abs))), 1e-300);
    this.names = all[0].filter(([name], i) => all.some((own) => { const v = own.find((o) => o[0] === name); return v && Math.max(...v[1].map(Math.abs)) > 1e-4 * most; }) || i === 0).map(([name]) => name);
    this.tables = all.map((own) => this.names.map((name) => own.find((o) => o[0] === name)?.[1] ?? new Float64Array(runs[0].frames)));
    this.now = document.createElement('div');
    this.now.className = 'now';
  }

  data() {
    const x = (run) => Array.from(run.time, (t) => (this.clock.stretched ? this.clock.index(t) : t));
    return uPlot.join(this.runs.map((run, r) => [x(run), ...this.tables[r].map((v) => Array.from(v))]));
  }

  make(ink, rule) {
    this.plot?.destroy();
    this.plot = undefined;
    const { unit, runs, names } = this, number = (v) => figure(v, unit, 3).trim();
    const axis = { stroke: ink, grid: { stroke: rule, width: 1 }, ticks: { stroke: rule, width: 1, size: 4 }, font: '11px system-ui, sans-serif' };
    const series = runs.flatMap((run, r) => names.map((name, i) => ({
      scale: i < this.left ? 'y' : 'z', label: runs.length > 1 ? `${name} ${r + 1}` : name, stroke: COLOURS[i % COLOURS.length], width: 1.5, dash: DASHES[r], points: { show: false }, spanGaps: true,
      value: (u, v) => (v === null || v === undefined ? '–' : unit ? figure(v, unit, 4) : String(v)),
    })));
    this.plot = new uPlot({
      width: this.element.clientWidth || 320, height: 150, legend: { live: true }, scales: { x: { time: false } },
      cursor: { x: false, y: false, points: { show: false }, drag: { x: false, y: false } },
      axes: [{ ...axis, size: 26, values: (u, v) => v.map((t) => (this.clock.stretched ? figure(this.clock.timeOf(t / Math.max(1, this.clock.times.length - 1)), 's', 2) : figure(t, 's', 3))), space: 70 },
        { ...axis, size: 50, values: (u, v) => v.map(number) },
        ...(this.left < names.length ? [{ ...axis, scale: 'z', side: 1, size: 44, grid: { show: false }, values: (u, v) => v.map(number) }] : [])],
      hooks: { ready: [() => { this.shown = undefined; this.follow(); }] },
      series: [{ label: 'time', value: (u, v) => (v === null || v === undefined ? '–' : figure(this.clock.stretched ? this.clock.timeOf(v / Math.max(1, this.clock.times.length - 1)) : v, 's', 4)) }, ...series],
    }, this.data(), this.element);
    const over = this.plot.over;
    over.append(this.now);
    const to = (event) => { const box = over.getBoundingClientRect(); this.seek(this.plot.posToVal(event.clientX - box.left, 'x')); };
    over.addEventListener('pointerdown', (event) => { over.setPointerCapture(event.pointerId); to(event); });
    over.addEventListener('pointermove', (event) => { if (event.buttons) to(event); });
  }

  follow() {
    if (!this.plot) return;
    const time = this.clock.time, x = this.clock.stretched ? this.clock.index(time) : time;
    this.now.style.left = `${this.plot.valToPos(x, 'x')}px`;
    const xs = this.plot.data[0];
    let low = 0, high = xs.length - 1;
    while (low < high) { const middle = (low + high + 1) >> 1; if (xs[middle] <= x * (1 + 1e-12)) low = middle; else high = middle - 1; }
    if (low !== this.shown) this.plot.setLegend({ idx: this.shown = low });
  }
}

export class Curves {
  constructor(runs, clock, seekTime) {
    const seek = (x) => seekTime(clock.stretched ? clock.timeOf(x / Math.max(1, clock.times.length - 1)) : x);
    this.curves = Object.keys(KINDS).map((kind) => new Curve(document.getElementById(kind), runs, kind, clock, seek));
  }
  make(ink, rule) { this.curves.forEach((curve) => curve.make(ink, rule)); }
  follow() { this.curves.forEach((curve) => curve.follow()); }
  resize() { this.curves.forEach((curve) => curve.plot.setSize({ width: curve.element.clientWidth, height: 150 })); this.follow(); }
}
