// Chromium: how large a page is, how long it takes to its first picture, and from picture to picture while it plays.
import { statSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const [path, source, most] = process.argv.slice(2), PICTURES = 60;
const { chromium } = await import(pathToFileURL(`${source}/src/view/web/node_modules/playwright-core/index.mjs`));
const median = (values) => values.toSorted((a, b) => a - b)[values.length >> 1];
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
});
try {
  const page = await (await browser.newContext({ viewport: { width: 1280, height: 800 }, offline: true })).newPage();
  const begin = performance.now();
  await page.goto(pathToFileURL(path).href);
  await page.evaluate(async () => { await window.shiver; await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))); });
  const first = performance.now() - begin;
  await page.click('#play');
  const gaps = await page.evaluate((count) => new Promise((done) => {
    const times = [];
    const tick = (now) => { times.push(now); if (times.length <= count) requestAnimationFrame(tick); else done(times.slice(1).map((t, i) => t - times[i])); };
    requestAnimationFrame(tick);
  }), PICTURES);
  const megabytes = statSync(path).size / 1e6, shown = await page.locator('#frame').textContent(), pieces = await page.locator('#pieces').textContent();
  console.log(`${pieces} pieces, ${shown}: ${megabytes.toFixed(2)} MB, first picture after ${(first / 1000).toFixed(1)} s, median of ${PICTURES} from picture to picture ${median(gaps).toFixed(0)} ms`);
  if (megabytes > Number(most)) { console.error(`the page is larger than ${most} MB`); process.exitCode = 1; }
} finally {
  await browser.close();
}
