// The line of time: when bodies were in fracture mode, and marks of impacts, splits and mode switches.
import { figure } from './units.js';

const MARKS = { wake: ['#e8762c', 0, 'impact'], split: ['#c2304a', 1, 'split'], sleep: ['#3f7fb5', 2, 'back to flight'], bin: ['#7d8791', 2, 'dust put away'] };
export const MARK_KEYS = Object.values(MARKS).slice(0, 3).map(([colour, , name]) => [name, colour]);
const LANES = 3, TOP = 4, LANE = 9;

export class Timeline {
  constructor(canvas, runs, clock, seek) {
    Object.assign(this, { canvas, runs, clock });
    const to = (event) => {
      const box = canvas.getBoundingClientRect();
      seek((event.clientX - box.left) / box.width);
    };
    canvas.addEventListener('pointerdown', (event) => { canvas.setPointerCapture(event.pointerId); to(event); });
    canvas.addEventListener('pointermove', (event) => { if (event.buttons) to(event); });
  }

  draw(ink, faint, rule) {
    const { canvas, clock } = this, ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const c = canvas.getContext('2d'), x = (time) => clock.placeOf(time) * (width - 2) + 1;
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, width, height);
    const bottom = TOP + LANES * LANE;
    c.fillStyle = rule;
    c.fillRect(0, TOP, width, LANES * LANE);
    this.runs.forEach((run, r) => this.drawRun(c, x, run, r, TOP + (r * LANES * LANE) / this.runs.length, LANES * LANE / this.runs.length));
    c.fillStyle = faint;
    c.font = '11px system-ui, sans-serif';
    c.textBaseline = 'bottom';
    for (const [place, align] of [[0, 'left'], [0.5, 'center'], [1, 'right']]) {
      c.textAlign = align;
      c.fillText(figure(clock.timeOf(place), 's', 3), place * width, height);
    }
    c.fillStyle = ink;
    const now = x(clock.time);
    c.fillRect(now - 1, 0, 2, bottom + 3);
    c.beginPath();
    c.arc(now, bottom + 3, 4, 0, 2 * Math.PI);
    c.fill();
    canvas.setAttribute('aria-valuemin', clock.first);
    canvas.setAttribute('aria-valuemax', clock.last);
    canvas.setAttribute('aria-valuenow', clock.time);
    canvas.setAttribute('aria-valuetext', figure(clock.time, 's', 4));
  }

  drawRun(c, x, run, r, top, height) {
    c.fillStyle = 'rgba(240,128,60,.22)';
    for (let f = 0; f < run.frames; f++) {
      if (run.curve.mode[f] < 1) continue;
      const begin = x(run.time[Math.max(0, f - 1)]), end = x(run.time[f]);
      c.fillRect(begin, top, Math.max(1, end - begin), height);
    }
    for (const event of run.events) {
      const mark = MARKS[event.kind];
      if (!mark) continue;
      c.fillStyle = mark[0];
      c.fillRect(x(event.time) - 0.75, top + mark[1] * height / LANES, 1.5, height / LANES - 1);
    }
  }
}
