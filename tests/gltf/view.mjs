// Loads a GLB in three.js in headless Chromium: node view.mjs FILE PICTURE
// Exit 1 when the page reports an error or the picture is blank.
import { readFile } from 'node:fs/promises';
import { dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const [file, picture] = process.argv.slice(2);
if (!file || !picture) {
  console.error('usage: node view.mjs FILE PICTURE');
  process.exit(2);
}
const here = dirname(fileURLToPath(import.meta.url));
const types = { '.html': 'text/html', '.js': 'text/javascript', '.glb': 'model/gltf-binary' };

function path_of(url) {
  const { pathname } = new URL(url);
  if (pathname === '/') return join(here, 'view.html');
  if (pathname === '/model.glb') return file;
  return join(here, 'node_modules', normalize(pathname));
}

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--headless', '--no-sandbox', '--disable-quic', '--no-first-run',
         '--disable-background-networking', '--disable-component-update', '--disable-sync',
         '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const problems = [];
try {
  const page = await browser.newPage({ viewport: { width: 600, height: 600 } });
  page.on('console', (m) => { if (m.type() === 'error') problems.push(m.text()); });
  page.on('pageerror', (e) => problems.push(String(e)));
  // Every request is answered from files: nothing listens on a port, nothing leaves the machine.
  await page.route('**/*', async (route) => {
    const path = path_of(route.request().url());
    if (path.endsWith('favicon.ico')) return route.fulfill({ status: 204 });
    try {
      await route.fulfill({ contentType: types[extname(path)] ?? 'application/octet-stream',
                            body: await readFile(path) });
    } catch (error) {
      problems.push(String(error));
      await route.abort();
    }
  });
  await page.goto('http://viewer.invalid/');
  await page.waitForFunction('window.result !== undefined', undefined, { timeout: 120000 });
  const result = await page.evaluate('window.result');
  await page.screenshot({ path: picture });
  console.log(`${file}: ${JSON.stringify(result)}`);
  if (result.error) problems.push(result.error);
  if (!(result.drawn > 0.02)) problems.push(`the picture is blank: ${result.drawn} of it is drawn`);
  if (!(result.colors > 8)) problems.push(`the picture has ${result.colors} colours only`);
} finally {
  await browser.close();
}
for (const p of problems) console.error(`  ${p}`);
console.log(`three.js: ${problems.length ? 0 : 1} passed, ${problems.length ? 1 : 0} failed`);
process.exit(problems.length ? 1 : 0);
