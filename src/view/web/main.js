import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { Bodies } from './bodies.js';
import { frameOf, place } from './camera.js';
import { Clock } from './clock.js';
import { CHOICES } from './colours.js';
import { Curves } from './curves.js';
import { Run } from './run.js';
import { MARK_KEYS, Timeline } from './timeline.js';
import { figure, plain } from './units.js';

const $ = (id) => document.getElementById(id);
const THEMES = {
  light: { back: '#f4f2ee', floor: '#e6e1d8', grid: '#cdc6b8', obstacle: '#a9a59c', ink: '#35322d', faint: '#8d877b', rule: '#ddd8ce' },
  dark: { back: '#1b1d20', floor: '#292c31', grid: '#3d4249', obstacle: '#6d7278', ink: '#e6e3dd', faint: '#92918c', rule: '#3a3e44' },
};
const LASTS = [[5, '5 s'], [10, '10 s'], [20, '20 s'], [60, '1 min'], [180, '3 min'], [0, 'as long as in nature']];
const SLOW = 0.05, PATIENCE = 4, LEAST_SHARPNESS = 0.5; // s from picture to picture; of them; pixels drawn over pixels shown
const KEYS = [['space', 'play or pause'], ['← →', 'one frame back or forth'], ['Home End', 'first or last frame'], ['[ ]', 'shorter or longer on the screen'],
  ['s', 'stretch: each frame as long as the others'], ['c', 'next colour'], ['x', 'convex pieces'], ['o', 'open walls'], ['d', 'dark or light'], ['r', 'camera back'], ['Esc', 'let go of the piece'], ['?', 'these keys']];

class Viewer {
  constructor(runs) {
    Object.assign(this, { runs, clock: new Clock(runs), playing: false, sharpness: 1, late: 0, picked: { run: -1, line: -1 }, choice: 'piece', states: {} });
    this.renderer = new THREE.WebGLRenderer({ canvas: $('view'), antialias: true });
    this.renderer.shadowMap.enabled = true;
    this.renderer.setScissorTest(true);
    this.renderer.autoClear = false;
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
    this.controls = new OrbitControls(this.camera, $('view'));
    this.controls.addEventListener('change', () => { this.dirty = true; });
    this.bodies = runs.map((run) => new Bodies(run));
    this.look(this.clock.first, this.clock.last);
    this.line = new Timeline($('line'), runs, this.clock, (at) => this.seek(at));
    this.curves = new Curves(runs, this.clock, (time) => { this.clock.time = time; this.pause(); });
    runs.forEach((run) => { const name = document.createElement('span'); name.textContent = runs.length > 1 ? run.name : ''; $('names').append(name); });
    this.fill();
    this.listen();
    this.setTheme(matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
    this.setColour('piece');
    this.layOut();
    this.resetCamera();
    this.setOpen(this.bodies.some((bodies) => bodies.enclosed));
    this.follow(new URLSearchParams(location.hash.slice(1)));
    this.last = performance.now();
    requestAnimationFrame((now) => this.tick(now));
  }

  // ---- controls

  fill() {
    LASTS.forEach(([seconds, name]) => $('lasts').append(new Option(name, seconds)));
    $('lasts').value = 10;
    Object.keys(CHOICES).filter((name) => this.runs.every((run) => CHOICES[name].has?.(run) ?? true)).forEach((name) => $('colour').append(new Option(name, name)));
    $('convex-label').hidden = this.runs.every((run) => run.hulls.length === 0);
    $('open-label').hidden = this.bodies.every((bodies) => bodies.walls.length === 0);
    const table = document.createElement('table');
    KEYS.forEach(([key, what]) => { const row = table.insertRow(); const k = document.createElement('kbd'); k.textContent = key; row.insertCell().append(k); row.insertCell().textContent = what; });
    $('help').append(table);
    const said = this.runs.map((run) => run.head).filter((head) => head.status !== 'finished').map((head) => `${head.name}: ${head.status}${head.message ? ': ' + head.message : ''}`);
    if (said.length) { const p = document.createElement('p'); p.className = 'hint'; p.textContent = said.join(' · '); $('picked').append(p); }
  }

  // What the page's address asks for: page.html#time=0.02&colour=damage&theme=dark&stretch&convex&open=no
  follow(wishes) {
    if (THEMES[wishes.get('theme')]) this.setTheme(wishes.get('theme'));
    if ([...$('colour').options].some((option) => option.value === wishes.get('colour'))) this.setColour(wishes.get('colour'));
    if (wishes.has('stretch')) this.setStretch(true);
    if (wishes.has('convex')) this.setConvex(true);
    if (wishes.has('open')) this.setOpen(wishes.get('open') !== 'no');
    if (Number.isFinite(parseFloat(wishes.get('time')))) this.clock.time = parseFloat(wishes.get('time'));
  }

  listen() {
    $('play').onclick = () => this.toggle();
    $('back').onclick = () => this.step(-1);
    $('forth').onclick = () => this.step(1);
    $('stretch').onchange = () => this.setStretch($('stretch').checked);
    $('convex').onchange = () => this.setConvex($('convex').checked);
    $('open').onchange = () => this.setOpen($('open').checked);
    $('colour').onchange = () => this.setColour($('colour').value);
    $('theme').onclick = () => this.setTheme(this.theme === 'dark' ? 'light' : 'dark');
    $('ask').onclick = () => { $('help').hidden = !$('help').hidden; };
    addEventListener('keydown', (event) => this.press(event));
    new ResizeObserver(() => { this.layOut(); this.curves.resize(); }).observe($('stage'));
    let down;
    $('view').addEventListener('pointerdown', (event) => { down = [event.clientX, event.clientY]; });
    $('view').addEventListener('pointerup', (event) => { if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 5) this.click(event); });
  }

  press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const inField = event.target instanceof HTMLSelectElement;
    const next = (select, by) => { select.selectedIndex = (select.selectedIndex + by + select.options.length) % select.options.length; select.onchange?.(); };
    const acts = {
      ' ': () => this.toggle(), ArrowLeft: () => this.step(-1), ArrowRight: () => this.step(1), Home: () => this.seek(0), End: () => this.seek(1),
      '[': () => next($('lasts'), -1), ']': () => next($('lasts'), 1), s: () => this.setStretch(!this.clock.stretched), c: () => next($('colour'), 1), x: () => this.setConvex(!$('convex').checked), o: () => this.setOpen(!$('open').checked),
      d: () => $('theme').onclick(), r: () => this.resetCamera(), Escape: () => { $('help').hidden = true; this.pick(-1, -1); }, '?': () => $('ask').onclick(),
    };
    if (!acts[event.key] || (inField && event.key.startsWith('Arrow'))) return;
    if (event.key === ' ' && event.target instanceof HTMLButtonElement && event.target.id !== 'play') return;
    event.preventDefault();
    acts[event.key]();
  }

  toggle() {
    this.playing = !this.playing;
    if (this.playing && this.clock.place >= 1) this.clock.place = 0;
    $('play').textContent = this.playing ? '❚❚' : '▶';
    $('play').setAttribute('aria-label', this.playing ? 'Pause' : 'Play');
    this.late = 0;
    this.sharpness = 1;
    this.layOut();
  }
  pause() { if (this.playing) this.toggle(); this.dirty = true; }
  seek(at) { this.clock.place = Math.min(1, Math.max(0, at)); this.pause(); }
  step(by) { this.clock.step(by); this.pause(); }
  setStretch(on) { this.clock.stretch(on); $('stretch').checked = on; const t = THEMES[this.theme]; this.curves.make(t.ink, t.rule); this.dirty = true; }

  setConvex(on) { $('convex').checked = on; this.bodies.forEach((bodies) => bodies.showHulls(on)); this.dirty = true; }

  setOpen(on) { $('open').checked = on; this.bodies.forEach((bodies) => bodies.showOpen(on)); this.dirty = true; }

  setTheme(theme) {
    this.theme = theme;
    document.documentElement.dataset.theme = theme;
    const t = THEMES[theme];
    this.bodies.forEach((bodies) => bodies.dress(t));
    this.curves.make(t.ink, t.rule);
    this.dirty = true;
  }

  setColour(name) {
    this.choice = name;
    $('colour').value = name;
    const state = (this.states[name] ??= CHOICES[name].prepare(this.runs)), legend = $('legend');
    legend.replaceChildren();
    const keys = (list) => { const p = document.createElement('div'); list.forEach(([word, colour]) => { const k = document.createElement('span'); k.className = 'key'; k.style.background = colour; p.append(k, word); }); legend.append(p); };
    if (state.keys) keys(state.keys);
    if (state.ramp) {
      const ramp = document.createElement('div'), ends = document.createElement('div');
      ramp.className = 'ramp'; ramp.style.background = state.ramp; ends.className = 'ends';
      [state.low, state.high].forEach((word) => { const s = document.createElement('span'); s.textContent = word; ends.append(s); });
      legend.append(state.title ?? name, ramp, ends);
    }
    keys(MARK_KEYS);
    this.dirty = true;
  }

  // ---- pieces

  click(event) {
    const box = $('view').getBoundingClientRect(), parts = this.parts(box.width, box.height);
    const x = event.clientX - box.left, y = event.clientY - box.top, r = parts.findIndex(([left, top, w, h]) => x >= left && x < left + w && y >= top && y < top + h);
    if (r < 0) return;
    const [left, top, w, h] = parts[r];
    this.aspect(w / h);
    const line = this.bodies[r].pick(this.renderer, this.camera, 2 * (x - left) / w - 1, 1 - 2 * (y - top) / h, w, h);
    this.pick(r, line);
  }

  pick(run, line) {
    this.picked = { run: line >= 0 ? run : -1, line };
    this.dirty = true;
    this.tell();
  }

  tell() {
    const table = $('picked').querySelector('table'), hint = $('picked').querySelector('.hint');
    table.replaceChildren();
    hint.hidden = this.picked.run >= 0;
    if (this.picked.run < 0) return;
    const run = this.runs[this.picked.run], { line } = this.picked, { frame } = run.find(this.clock.time), id = run.carrierAt(frame, line);
    const row = (name, value) => { const r = table.insertRow(); r.insertCell().textContent = name; const cell = r.insertCell(); cell.textContent = value; cell.dataset.name = name; };
    if (id < 0) { row('piece', 'not there at this time'); return; }
    const piece = run.fragment[id], v = run.velocity(frame, line), p = run.centre(frame, line);
    row('piece', id); row('line', piece.line); row('object', run.head.objects[piece.object]); row('parent', piece.parent < 0 ? 'none' : piece.parent);
    row('mass', plain(piece.mass, 'kg', 6)); row('tets', piece.tets); row('born', figure(piece.birth, 's', 6));
    row('ends', Number.isFinite(piece.death) ? figure(piece.death, 's', 6) : 'no'); row('mode', run.awakeAt(frame, line) ? 'fracture' : 'flight');
    row('position', p.map((c) => Number(c.toPrecision(4))).join(', ') + ' m'); row('velocity', v.map((c) => Number(c.toPrecision(4))).join(', ') + ' m/s');
    row('speed', plain(Math.hypot(...v), 'm/s', 5));
  }

  // ---- pictures

  // What is seen from one time to another is what lamp and camera are set for.
  look(from, to) {
    this.view = frameOf(this.runs, from, to);
    this.bodies.forEach((bodies) => bodies.surround(this.view.centre, this.view.reach));
  }

  resetCamera() { const [, , w, h] = this.parts(this.width, this.height)[0]; this.aspect(w / h); place(this.camera, this.controls, this.view, w / h); this.dirty = true; }
  aspect(a) { this.camera.aspect = a; this.camera.updateProjectionMatrix(); }

  // Left, top, width and height of each run's part of the picture: beside or above each other.
  parts(width, height) {
    const n = this.runs.length, beside = width >= height;
    return this.runs.map((_, i) => (beside ? [i * width / n, 0, width / n, height] : [0, i * height / n, width, height / n]));
  }

  layOut() {
    this.width = $('stage').clientWidth;
    this.height = $('stage').clientHeight;
    this.renderer.setPixelRatio(this.sharpness * Math.min(2, devicePixelRatio || 1));
    this.renderer.setSize(this.width, this.height, false);
    this.dirty = true;
  }

  render(width, height) {
    const { time } = this.clock;
    this.parts(width, height).forEach(([left, top, w, h], i) => {
      const run = this.runs[i], at = { ...run.find(time), time }, bodies = this.bodies[i];
      const carrier = this.picked.run === i ? run.carrierAt(at.frame, this.picked.line) : -2;
      bodies.show(at, this.choice, this.states[this.choice], carrier);
      this.aspect(w / h);
      this.renderer.setViewport(left, height - top - h, w, h);
      this.renderer.setScissor(left, height - top - h, w, h);
      this.renderer.clear();
      this.renderer.render(bodies.scene, this.camera);
    });
  }

  words() {
    const { time } = this.clock, all = this.runs.map((run) => ({ run, ...run.find(time) }));
    const join = (of) => all.map(of).join(' | ');
    $('time').textContent = figure(time, 's', 4);
    $('pieces').textContent = join(({ run, frame }) => run.curve.alive[frame]);
    $('pieces-word').textContent = all.length === 1 && all[0].run.curve.alive[all[0].frame] === 1 ? 'piece' : 'pieces';
    $('kinetic').textContent = join(({ run, frame }) => plain(run.curve.kinetic[frame], 'J', 6));
    $('mode').textContent = join(({ run, frame }) => (run.curve.mode[frame] > 0 ? 'fracture' : 'flight'));
    $('frame').textContent = `frame ${join(({ run, frame }) => run.curve.number[frame])} of ${join(({ run }) => run.head.allFrames - 1)}`;
  }

  // Where pictures take long (no graphics processor), those that move are coarser; a pause shows the whole again.
  keepUp(passed) {
    this.late = passed > SLOW ? this.late + 1 : 0;
    if (this.late < PATIENCE || this.sharpness <= LEAST_SHARPNESS) return;
    this.late = 0;
    this.sharpness *= 0.7;
    this.layOut();
  }

  tick(now) {
    const passed = Math.min(0.1, (now - this.last) / 1000), start = performance.now();
    this.last = now;
    if (this.playing) this.keepUp(passed);
    if (this.playing) {
      const given = Number($('lasts').value), natural = Math.max(1e-3, this.clock.last - this.clock.first);
      this.clock.place += passed / (given || (this.clock.stretched ? 10 : natural));
      if (this.clock.place >= 1) { this.clock.place = 1; this.toggle(); }
      this.dirty = true;
    }
    if (this.dirty) {
      this.dirty = false;
      this.render(this.width, this.height);
      this.words();
      if (this.picked.run >= 0) this.tell();
      const t = THEMES[this.theme];
      this.line.draw(t.ink, t.faint, t.rule);
      this.curves.follow();
      this.costs?.push(performance.now() - start);
    }
    requestAnimationFrame((next) => this.tick(next));
  }

  // One picture as a data URL, with time and pieces written on it: for `shiver export png`.
  capture(time, width, height) {
    const clean = document.createElement('canvas'), c = clean.getContext('2d');
    this.pause();
    this.clock.time = time;
    this.renderer.setPixelRatio(1);
    this.renderer.setSize(width, height, false);
    const [, , w, h] = this.parts(width, height)[0];
    this.aspect(w / h);
    if (this.captured !== `${width} ${height}`) place(this.camera, this.controls, this.view, w / h);
    this.captured = `${width} ${height}`;
    this.render(width, height);
    Object.assign(clean, { width, height });
    c.drawImage($('view'), 0, 0);
    const size = Math.max(11, Math.round(height / 26)), ink = THEMES[this.theme];
    c.font = `600 ${size}px Helvetica, Arial, sans-serif`;
    c.fillStyle = ink.ink;
    this.words();
    c.fillText($('time').textContent, size, 1.7 * size);
    c.font = `${Math.round(0.75 * size)}px Helvetica, Arial, sans-serif`;
    c.fillStyle = ink.faint;
    c.fillText(`${$('pieces').textContent} ${$('pieces-word').textContent}`, size, 2.8 * size);
    return clean.toDataURL('image/png');
  }
}

async function start() {
  const began = performance.now();
  if (typeof DecompressionStream === 'undefined') throw new Error('this browser is too old for this page: it lacks DecompressionStream (Chromium 80, Firefox 113, Safari 16.4 have it)');
  const runs = [];
  for (const element of document.querySelectorAll('script.run')) runs.push(await Run.from(element));
  const viewer = new Viewer(runs);
  viewer.started = performance.now() - began;
  return viewer;
}

// For `shiver export png` and for tests.
window.shiver = start();
window.shiver.catch((error) => { $('message').textContent = error.message; $('message').hidden = false; });
