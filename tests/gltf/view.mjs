// Opens GLB files in three.js and in model-viewer, in headless Chromium:
//   node view.mjs FOLDER FILE...                  pictures FOLDER/NAME.READER.png
//   node view.mjs --letters IMAGE FOLDER FILE...  the same for boxes that carry samples/letters.png
// Exit 1 when a page reports an error, when a picture is blank, or when a letter does not stand on
// its side of the box, upright and not mirrored.
import { readFile } from 'node:fs/promises';
import { basename, dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';
import { PNG } from 'pngjs';
import { mismatches, sides, tooMild } from './letters.mjs';

let args = process.argv.slice(2), letters;
if (args[0] === '--letters') [letters, args] = [args[1], args.slice(2)];
const [folder, ...files] = args;
if (files.length === 0) {
  console.error('usage: node view.mjs [--letters IMAGE] FOLDER FILE...');
  process.exit(2);
}
const here = dirname(fileURLToPath(import.meta.url));
const types = { '.html': 'text/html', '.js': 'text/javascript', '.glb': 'model/gltf-binary' };
const kSize = 600;  // of the page, in pixels

function pathOf(url) {
  const { pathname } = new URL(url);
  if (pathname.startsWith('/files/')) return files[parseInt(pathname.slice(7), 10)];
  if (extname(pathname) === '.html') return join(here, basename(pathname));
  return join(here, 'node_modules', normalize(pathname));
}

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--headless', '--no-sandbox', '--disable-quic', '--no-first-run',
         '--disable-background-networking', '--disable-component-update', '--disable-sync',
         '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});

const shot = async (page, path) => PNG.sync.read(await page.screenshot({ path }));

/** What is wrong with a picture that should show something on white, and a texture if there is one. */
function blank({ data: rgba }, textured) {
  const colors = new Set();
  let drawn = 0;
  for (let i = 0; i < rgba.length; i += 4) {
    if (rgba[i] > 250 && rgba[i + 1] > 250 && rgba[i + 2] > 250) continue;
    ++drawn;
    colors.add((rgba[i] >> 4) * 256 + (rgba[i + 1] >> 4) * 16 + (rgba[i + 2] >> 4));
  }
  const share = drawn / (kSize * kSize);
  if (share < 0.02) return [`the picture is blank: ${share} of it is drawn`];
  return colors.size > (textured ? 8 : 1) ? [] : [`the picture has ${colors.size} colours only`];
}

/** Looks at every side of the box of letters through a lens that sees it whole. */
async function lookAround(page, url, picture) {
  const image = PNG.sync.read(await readFile(letters)), problems = [];
  const distance = 12, fov = 15, reach = Math.tan((fov * Math.PI) / 360);
  for (const side of sides) {
    await page.evaluate(([u, eye]) => window.show(u, eye), [url, { theta: side.theta, phi: side.phi, distance, fov }]);
    const seen = await shot(page, `${picture}.${side.letter}.png`);
    const spot = (x, y) => {
      const scale = kSize / 2 / ((distance - side.depth) * reach);
      const at = Math.floor(kSize / 2 - y * scale) * seen.width + Math.floor(kSize / 2 + x * scale);
      return seen.data.subarray(4 * at, 4 * at + 3);
    };
    problems.push(...mismatches(side, image, spot), ...tooMild(side, image, spot));
  }
  return problems;
}

let failed = 0;
try {
  for (const reader of ['three', 'model_viewer']) {
    const page = await browser.newPage({ viewport: { width: kSize, height: kSize } });
    let problems = [];
    page.on('console', (m) => { if (m.type() === 'error') problems.push(m.text()); });
    page.on('pageerror', (e) => problems.push(String(e)));
    // Every request is answered from files: nothing listens on a port, nothing leaves the machine.
    await page.route('**', async (route) => {
      const url = route.request().url();
      if (/^(data|blob):/.test(url)) return route.continue();
      try {
        const path = pathOf(url);
        await route.fulfill({ contentType: types[extname(path)] ?? 'application/octet-stream', body: await readFile(path) });
      } catch (error) {
        problems.push(String(error));
        await route.abort();
      }
    });
    await page.goto(`http://viewer.invalid/${reader}.html`);
    await page.waitForFunction('window.show !== undefined', undefined, { timeout: 120000 });
    for (const [i, file] of files.entries()) {
      problems = [];
      const url = `/files/${i}.glb`, picture = join(folder, `${basename(file, '.glb')}.${reader}`);
      try {
        if (letters) {
          problems.push(...await lookAround(page, url, picture));
        } else {
          console.log(`${file}: ${JSON.stringify(await page.evaluate((u) => window.show(u), url))}`);
          problems.push(...blank(await shot(page, `${picture}.png`), (await readFile(file)).includes('"images"')));
        }
      } catch (error) {
        problems.push(String(error));
      }
      console.log(`${reader}: ${basename(file)} ${problems.length ? 'FAILED' : 'ok'}`);
      for (const p of problems) console.log(`  ${p}`);
      failed += problems.length > 0;
    }
    await page.close();
  }
} finally {
  await browser.close();
}
process.exit(failed ? 1 : 0);
