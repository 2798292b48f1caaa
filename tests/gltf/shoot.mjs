// Pictures of a report's page: node shoot.mjs PAGE.html OUT KEYS WIDTHxHEIGHT
// KEYS are pressed in turn, '_' stands for none; the picture after each is OUT_KEY.png.
import { chromium } from 'playwright-core';
import { pathToFileURL } from 'node:url';

const [file, out, keys, size = '1200x620'] = process.argv.slice(2);
const [width, height] = size.split('x').map(Number);
const browser = await chromium.launch({
  executablePath: '/usr/bin/chromium',
  args: ['--headless', '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const page = await browser.newPage({ viewport: { width, height } });
await page.goto(pathToFileURL(file).href);
await page.waitForFunction('window.crosspatch !== undefined', undefined, { timeout: 120000 });
for (const key of keys) {
  if (key !== '_') await page.keyboard.press(key);
  await page.waitForTimeout(300);
  await page.evaluate('window.crosspatch.draw()');
  await page.screenshot({ path: `${out}_${key}.png` });
}
await browser.close();
