/** Takes the pictures of the README and the frames of its moving one. Usage: node test/pictures.mjs PAGE.html FOLDER */

import { mkdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const [page, folder] = process.argv.slice(2);
if (!folder) throw new Error('usage: node test/pictures.mjs PAGE.html FOLDER');
const address = pathToFileURL(resolve(page)).href, frames = join(folder, 'frames');
mkdirSync(frames, { recursive: true });
/** Frames of the moving picture, and which share of the run it shows. */
const FRAMES = 80, SHOWN = 0.8, STILL = 0.4;

const browser = await chromium.launch({ executablePath: process.env.BROWSER || '/usr/bin/chromium', args: ['--headless', '--no-sandbox', '--disable-gpu', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });

async function open(options) {
  const context = await browser.newContext(options), one = await context.newPage();
  await one.goto(address);
  await one.waitForFunction(() => document.documentElement.dataset.ready === 'true');
  return one;
}

/** To a share of the run. */
async function seek(one, share) {
  await one.evaluate((s) => { const { data, shown, seek: to } = window.springpot; to(s * Math.max(...shown().map((i) => data.cases[i].end))); }, share);
  await one.waitForFunction(() => window.springpot.drawn() === window.springpot.time());
}

for (const [name, options] of Object.entries({
  'view-light': { viewport: { width: 1280, height: 800 }, colorScheme: 'light' },
  'view-dark': { viewport: { width: 1280, height: 800 }, colorScheme: 'dark' },
  'view-phone': { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true, colorScheme: 'light' },
})) {
  const one = await open(options);
  await seek(one, STILL);
  await one.waitForTimeout(400);
  await one.screenshot({ path: join(folder, `${name}.png`) });
  await one.context().close();
}

// The robot and one plot, without what is there to be clicked; the page's own policy would not let a style in.
const one = await open({ viewport: { width: 640, height: 560 }, colorScheme: 'light', bypassCSP: true, reducedMotion: 'reduce' });
for (let n = await one.locator('.plot').count(); n > 1; n--) await one.locator('.plot').last().locator('button').nth(1).click();
await one.addStyleTag({ content: '#bar, #transport, #side, #reset, .add, .corner, .plot header button, #colorbar { display: none !important } #view { position: static !important; height: 360px !important } #plots { padding: 8px !important } .plot { height: 184px !important } main { overflow: hidden !important }' });
await one.locator('#view canvas').evaluate(() => window.dispatchEvent(new Event('resize')));
await one.waitForTimeout(500);
await one.keyboard.press('r');
await one.waitForTimeout(300);
for (let i = 0; i < FRAMES; i++) {
  await seek(one, (SHOWN * i) / (FRAMES - 1));
  await one.screenshot({ path: join(frames, `${String(i).padStart(3, '0')}.png`) });
}
await browser.close();
