// Uses a report's page in headless Chromium as a person would:
//   node report.mjs PROGRAM SOURCE.obj TARGET.obj FOLDER
// Makes the report of the pair in FOLDER, then checks that the page says no error and asks for no
// other file, that the pointer on one surface shows its image on the other, that every layer
// changes the picture, and that landmarks saved from the page steer the next run. The pictures stay
// in FOLDER. Exit 1 when anything fails.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const [program, source, target, folder] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node report.mjs PROGRAM SOURCE.obj TARGET.obj FOLDER');
  process.exit(2);
}
const at = (name) => join(folder, name);
let failed = 0;
function check(good, what) {
  if (!good) ++failed;
  console.log(`${good ? 'ok    ' : 'FAILED'} ${what}`);
}

/** Vertices and triangles of an OBJ file of triangles. */
function readObj(path) {
  const vertices = [], triangles = [];
  for (const line of readFileSync(path, 'utf8').split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'v') vertices.push(words.slice(1, 4).map(Number));
    if (words[0] === 'f') triangles.push(words.slice(1, 4).map((w) => parseInt(w, 10) - 1));
  }
  return { vertices, triangles };
}

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
function size(mesh) {
  const extent = (k) => {
    const values = mesh.vertices.map((v) => v[k]);
    return Math.max(...values) - Math.min(...values);
  };
  return Math.max(extent(0), extent(1), extent(2));
}

const meshes = { source: readObj(source), target: readObj(target) };
execFileSync(program, ['map', source, target, '--quiet', '-o', at('map.txt'), '--report', at('report.html')]);
const images = readFileSync(at('map.txt'), 'utf8').trim().split('\n').map((line) => {
  const [face, ...weights] = line.split(' ').map(Number);
  return [0, 1, 2].map((k) =>
    meshes.target.triangles[face].reduce((sum, v, i) => sum + weights[i] * meshes.target.vertices[v][k], 0));
});

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--headless', '--no-sandbox', '--disable-quic', '--no-first-run',
         '--disable-background-networking', '--disable-component-update', '--disable-sync',
         '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
try {
  const page = await browser.newPage({ viewport: { width: 1300, height: 1000 } });
  const problems = [], asked = [];
  page.on('console', (m) => { if (m.type() === 'error') problems.push(m.text()); });
  page.on('pageerror', (e) => problems.push(String(e)));
  page.on('request', (r) => { if (!/^(data|blob):/.test(r.url())) asked.push(r.url()); });
  const begun = Date.now();
  await page.goto(pathToFileURL(at('report.html')).href);
  await page.waitForFunction('window.crosspatch !== undefined', undefined, { timeout: 120000 });
  console.log(`       the page was ready after ${((Date.now() - begun) / 1000).toFixed(1)} s`);
  await page.waitForTimeout(500);
  check(asked.length === 1, `the page asks for nothing but itself (${asked.length} requests)`);

  const status = () => page.locator('#status').textContent();
  /** Where a point is drawn, and what the page says when the pointer goes there. */
  async function point(side, place) {
    const [x, y] = await page.evaluate(([s, p]) => window.crosspatch.screen(s, p), [side, place]);
    await page.mouse.move(x, y);
    await page.waitForTimeout(60);
    const found = (await status()).match(/\(([^)]*)\).*\(([^)]*)\)/);
    return found ? { x, y, points: [found[1], found[2]].map((t) => t.split(',').map(Number)) } : null;
  }
  /** Vertices of a mesh that are seen from the camera, evenly spread over its list. */
  async function visible(side, wanted) {
    const list = meshes[side].vertices, seen = [];
    for (let i = 0; i < 60 && seen.length < wanted; ++i) {
      const v = Math.floor(((i * 37) % 60) * list.length / 60);
      const hit = await point(side, list[v]);
      if (hit && distance(hit.points[0], list[v]) < 0.01 * size(meshes[side])) seen.push({ v, ...hit });
    }
    return seen;
  }

  const seen = await visible('source', 10);
  check(seen.length >= 5, `${seen.length} vertices of the source can be pointed at`);
  const worst = Math.max(...seen.map(({ v, points }) => distance(points[1], images[v])));
  check(worst < 0.01 * size(meshes.target),
        `the pointer's image is right to ${(100 * worst / size(meshes.target)).toFixed(2)} % of the target`);
  // And back: the image of the image is the point itself.
  let back = 0, tried = 0;
  for (const { v } of seen) {
    const hit = await point('target', images[v]);
    if (!hit || distance(hit.points[0], images[v]) > 0.01 * size(meshes.target)) continue;
    back = Math.max(back, distance(hit.points[1], meshes.source.vertices[v]));
    ++tried;
  }
  check(tried >= 3 && back < 0.02 * size(meshes.source),
        `from the target back to the source it is right to ${(100 * back / size(meshes.source)).toFixed(2)} % (${tried} points)`);
  await page.mouse.move(5, 5);

  /** Share of the drawn pixels that differ from the picture kept before. */
  const changed = () => page.evaluate(() => {
    window.crosspatch.draw();
    const canvas = document.querySelector('canvas');
    const copy = document.createElement('canvas');
    copy.width = canvas.width;
    copy.height = canvas.height;
    const pen = copy.getContext('2d');
    pen.drawImage(canvas, 0, 0);
    const now = pen.getImageData(0, 0, copy.width, copy.height).data;
    const before = window.before;
    window.before = now;
    if (!before) return 0;
    let drawn = 0, different = 0;
    for (let i = 0; i < now.length; i += 4) {
      if (now[i + 3] === 0 && before[i + 3] === 0) continue;
      ++drawn;
      if (Math.abs(now[i] - before[i]) + Math.abs(now[i + 1] - before[i + 1]) + Math.abs(now[i + 2] - before[i + 2]) > 12) ++different;
    }
    return drawn > 0 ? different / drawn : 0;
  });
  const shot = (name) => page.screenshot({ path: at(`report_${name}.png`) });
  await changed();
  await shot('1');
  for (const key of ['2', '3', '4', '5', '6']) {
    await page.keyboard.press(key);
    const share = await changed();
    await shot(key);
    check(share > 0.2, `layer ${key} changes ${(100 * share).toFixed(0)} % of the picture`);
  }
  await page.keyboard.press('1');
  await changed();
  for (const key of ['c', 'a', 'g', 'm', 's']) {
    await page.keyboard.press(key);
    const share = await changed();
    await shot(key);
    await page.keyboard.press(key);
    const undone = await changed();
    check(share > 1e-4 && undone > 1e-4, `overlay ${key} comes and goes (${(100 * share).toFixed(2)} % of the picture)`);
  }
  const maps = await page.evaluate('window.crosspatch.data.maps.length');
  if (maps > 1) {
    await page.keyboard.press('r');
    const share = await changed();
    await shot('r');
    check(share > 0.05, `the runner-up beside it changes ${(100 * share).toFixed(1)} % of the picture`);
    await page.keyboard.press('r');
  }

  // Every axis can point up, and the sixth press brings back the first.
  await changed();
  const ups = [];
  for (let i = 0; i < 6; ++i) {
    await page.keyboard.press('u');
    ups.push(await page.getByRole('button', { name: 'Up:' }).textContent());
    if (i < 5) check(await changed() > 0.05, `the surfaces are turned: ${ups.at(-1)}`);
  }
  await changed();
  check(new Set(ups).size === 6, 'six axes can point up');

  // Turning one surface turns both while they are linked.
  await changed();
  const box = await page.locator('#source').boundingBox();
  await page.mouse.move(box.x + 20, box.y + box.height - 20);
  await page.mouse.down();
  await page.mouse.move(box.x + 90, box.y + box.height - 40, { steps: 4 });
  await page.mouse.up();
  check(await changed() > 0.02, 'dragging turns the surfaces');

  // A landmark: added on the source, its end on the target dragged to another vertex, saved.
  const [first] = await visible('source', 1);
  const ends = await visible('target', 12);
  await page.getByRole('button', { name: 'Add landmark' }).click();
  await page.mouse.click(first.x, first.y);
  const placed = await page.evaluate(() => document.querySelectorAll('button[disabled]').length);
  check(placed === 0, 'a click adds a landmark');
  const end = await page.evaluate(([s, p]) => window.crosspatch.screen(s, p), ['target', images[first.v]]);
  const goal = ends.map((e) => ({ ...e, d: distance(meshes.target.vertices[e.v], images[first.v]) }))
    .sort((a, b) => a.d - b.d).find((e) => e.d > 0.03 * size(meshes.target)) ?? ends[0];
  await page.mouse.move(end[0], end[1]);
  await page.mouse.down();
  await page.mouse.move(goal.x, goal.y, { steps: 5 });
  await page.waitForTimeout(100);
  await page.mouse.up();
  await shot('landmark');
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('button', { name: 'Save landmarks' }).click(),
  ]);
  await download.saveAs(at('landmarks.txt'));
  const pair = readFileSync(at('landmarks.txt'), 'utf8').trim().split('\n').at(-1).split(' ').map(Number);
  check(distance(meshes.source.vertices[pair[0]], meshes.source.vertices[first.v]) < 0.02 * size(meshes.source),
        `the file names the source's vertex (${pair[0]})`);
  execFileSync(program, ['map', source, target, '--quiet', '-o', at('steered.txt'), '--landmarks', at('landmarks.txt')],
               { stdio: ['ignore', 'ignore', 'pipe'] });
  const [face, ...weights] = readFileSync(at('steered.txt'), 'utf8').split('\n')[pair[0]].split(' ').map(Number);
  const reached = meshes.target.triangles[face][weights.indexOf(Math.max(...weights))];
  check(reached === pair[1] && Math.max(...weights) > 1 - 1e-6, `the next run takes vertex ${pair[0]} to vertex ${pair[1]}`);
  await page.getByRole('button', { name: 'Delete landmark' }).click();
  check(await page.getByRole('button', { name: 'Save landmarks' }).isDisabled(), 'the landmark can be deleted');

  await page.emulateMedia({ colorScheme: 'dark' });
  await page.setViewportSize({ width: 420, height: 900 });
  await page.waitForTimeout(300);
  await shot('narrow_dark');
  check(problems.length === 0, `no errors on the console${problems.map((p) => `\n         ${p}`).join('')}`);
} finally {
  await browser.close();
}
console.log(`report: ${failed === 0 ? 'passed' : `${failed} checks failed`}`);
process.exit(failed === 0 ? 0 : 1);
