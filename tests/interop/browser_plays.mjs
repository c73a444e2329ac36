// Chromium: the page plays, scrubs and is clicked, and what it says is what the run file has.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const [folder, source] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(`${source}/src/view/web/node_modules/playwright-core/index.mjs`));

function table(name) {
  const [head, ...lines] = readFileSync(`${folder}/run_${name}.csv`, 'utf8').trim().split('\n').map((line) => line.split(','));
  return lines.map((line) => Object.fromEntries(head.map((key, i) => [key, line[i]])));
}
const ledger = table('ledger'), genealogy = table('genealogy'), trajectories = table('trajectories');
const problems = [];
function check(condition, message) { if (!condition) problems.push(message); }
const near = (a, b, share) => Math.abs(a - b) <= share * Math.max(Math.abs(a), Math.abs(b), 1e-12);

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
});
try {
  const context = await browser.newContext({ viewport: { width: 900, height: 600 }, offline: true });
  const page = await context.newPage(), asked = [];
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) asked.push(request.url()); });
  page.on('pageerror', (error) => problems.push(`script: ${error.message}`));
  page.on('dialog', (dialog) => { problems.push('a text of the scene became a script'); dialog.dismiss(); });
  await page.goto(pathToFileURL(`${folder}/run.html`).href);
  await page.evaluate(() => window.shiver);
  check((await page.title()) === '<b>bar</b> & step', `title: ${await page.title()}`);
  const text = (id) => page.locator(`#${id}`).textContent();
  const frameShown = async () => Number(/^frame (\d+) of/.exec(await text('frame'))[1]);
  const settle = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

  // Every tenth frame: pieces and kinetic energy.
  const compare = async () => {
    await settle();
    const frame = await frameShown(), row = ledger[frame];
    const living = trajectories.filter((r) => r['time [s]'] === row['time [s]']).length;
    check(Number(await text('pieces')) === living, `frame ${frame}: ${await text('pieces')} pieces, ${living} in the run file`);
    check(near(parseFloat(await text('kinetic')), Number(row['kinetic [J]']), 1e-5), `frame ${frame}: ${await text('kinetic')}, ${row['kinetic [J]']} in the run file`);
    return frame;
  };
  check((await compare()) === 0, 'does not begin at frame 0');
  for (let i = 0; i < 3; i++) await page.keyboard.press('ArrowRight');
  check((await compare()) === 3, 'the right arrow does not go one frame on');
  await page.keyboard.press('End');
  check((await compare()) === ledger.length - 1, 'End does not go to the last frame');

  // A frame's time is that frame, in time and in frames, whatever is lost on the way to a place on the screen and back.
  const lost = await page.evaluate(async () => {
    const view = await window.shiver, lines = [view.clock.times];
    for (const rate of [240, 1e3, 3e4]) lines.push(Array.from({ length: 400 }, (_, i) => 0.1 + i / rate));
    let missed = 0;
    for (const time of lines)
      for (const stretched of [false, true]) {
        const clock = new view.clock.constructor([{ time }]);
        clock.stretch(stretched);
        for (const t of time) { clock.time = t; missed += clock.time !== t; }
      }
    return missed;
  });
  check(lost === 0, `${lost} frames are missed by their own time`);

  // Scrubs to the middle of the line of time.
  const line = await page.locator('#line').boundingBox();
  await page.mouse.click(line.x + line.width / 2, line.y + 10);
  const middle = await compare();
  check(Math.abs(middle - (ledger.length - 1) / 2) <= 1, `the middle of the line of time is frame ${middle}`);

  // Plays.
  await page.keyboard.press('Home');
  await page.selectOption('#lasts', '5');
  await page.click('#play');
  await page.waitForFunction(() => /^frame ([1-9]|\d\d)/.test(document.getElementById('frame').textContent), null, { timeout: 20000 });
  await page.click('#play');
  check((await compare()) > 0, 'does not play');

  // All colours, stretched time, dark.
  for (const colour of ['mode', 'age', 'speed', 'mass', 'damage', 'stress', 'piece']) { await page.selectOption('#colour', colour); await settle(); }
  await page.keyboard.press('s');
  await page.keyboard.press('d');
  await compare();

  // The convex pieces are drawn over the bodies, and go again.
  const picture = async () => { await settle(); return page.evaluate(async () => { const v = await window.shiver; v.render(v.width, v.height); return document.getElementById('view').toDataURL(); }); };
  const plain = await picture();
  await page.keyboard.press('x');
  check((await picture()) !== plain && (await page.isChecked('#convex')), 'x draws no convex pieces');
  await page.keyboard.press('x');
  check((await picture()) === plain, 'x does not take the convex pieces away');

  // The step is a wall, round nothing: it is opened when asked to be.
  check(!(await page.isChecked('#open')), 'a wall is open that is round nothing');
  await page.keyboard.press('o');
  check((await picture()) !== plain, 'o opens no wall');
  await page.keyboard.press('o');
  check((await picture()) === plain, 'o does not close the wall');

  // Clicks the piece whose centre is nearest to the viewer; its mass and birth are those of the genealogy.
  await page.keyboard.press('End');
  await settle();
  const place = await page.evaluate(async () => {
    const v = await window.shiver, run = v.runs[0], box = document.getElementById('view').getBoundingClientRect();
    v.aspect(v.width / v.height);
    v.camera.updateMatrixWorld();
    const seen = Array.from({ length: run.count }, (_, line) => {
      const p = v.camera.position.clone().set(...run.pose({ frame: run.frames - 1, next: run.frames - 1, share: 0 }, line, new Float64Array(7)).slice(0, 3));
      const away = p.distanceTo(v.camera.position), q = p.project(v.camera);
      return { mass: run.fragment[run.leaf[line]].mass, away, x: box.left + (q.x + 1) / 2 * box.width, y: box.top + (1 - q.y) / 2 * box.height };
    });
    return seen.sort((a, b) => b.mass - a.mass)[0];
  });
  await page.mouse.click(place.x, place.y);
  await settle();
  const cell = (name) => page.locator(`#picked td[data-name="${name}"]`).textContent();
  const id = Number(await cell('piece')), row = genealogy[id];
  check(row && near(parseFloat(await cell('mass')), Number(row['mass [kg]']), 1e-5), `piece ${id}: ${await cell('mass')}, ${row?.['mass [kg]']} in the run file`);
  check((await cell('line')) === row?.line, `piece ${id}: line ${await cell('line')}`);
  const last = trajectories.filter((r) => Number(r.fragment) === id).at(-1), speed = Math.hypot(...['x', 'y', 'z'].map((k) => Number(last[`v.${k} [m/s]`])));
  check(near(parseFloat(await cell('speed')), speed, 2e-3) || speed < 1e-3, `piece ${id}: ${await cell('speed')}, ${speed} in the run file`);
  check(asked.length === 0, `asks the network for ${asked}`);
} finally {
  await browser.close();
}
if (problems.length) { console.error(problems.join('\n')); process.exit(1); }
console.log(`as in the run file: ${ledger.length} frames, ${genealogy.length} pieces ever`);
