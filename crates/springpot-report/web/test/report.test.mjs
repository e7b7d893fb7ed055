/**
 * Opens reports in a browser. REPORTS names a folder with NAME/report.html, NAME/comparison.html where there is one, and NAME/summary.csv. BROWSER names the
 * browser's program.
 */

import assert from 'node:assert/strict';
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';
import { parse } from './csv.mjs';

const folder = resolve(process.env.REPORTS);
const pages = readdirSync(folder).flatMap((name) => ['report', 'comparison'].map((kind) => [name, kind])).filter(([name, kind]) => existsSync(join(folder, name, `${kind}.html`)));
assert.ok(pages.length > 0, `${folder} holds no reports`);

/** @type {import('playwright-core').Browser} */
let browser;
before(async () => { browser = await chromium.launch({ executablePath: process.env.BROWSER || '/usr/bin/chromium', args: ['--headless', '--no-sandbox', '--disable-gpu', '--no-first-run'] }); });
after(() => browser?.close());

async function open(name, kind, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1100, height: 900 }, colorScheme: 'light', ...options });
  const page = await context.newPage();
  const seen = { errors: [], requests: [], dialogs: 0 };
  page.on('console', (message) => { if (message.type() === 'error') seen.errors.push(message.text()); });
  page.on('pageerror', (error) => seen.errors.push(String(error)));
  page.on('request', (request) => { if (!request.url().startsWith('data:')) seen.requests.push(request.url()); });
  page.on('dialog', (dialog) => { seen.dialogs++; dialog.dismiss(); });
  const address = pathToFileURL(join(folder, name, `${kind}.html`)).href;
  await page.goto(address);
  return { page, seen, address, close: () => context.close() };
}

for (const [name, kind] of pages) {
  describe(`${name}: ${kind}`, () => {
    for (const [what, options] of [['a desk', {}], ['the dark', { colorScheme: 'dark' }], ['a phone', { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true }]]) {
      test(`loads by itself and fits ${what}`, async () => {
        const { page, seen, address, close } = await open(name, kind, options);
        assert.deepEqual(seen.errors, []);
        assert.deepEqual(seen.requests, [address]);
        assert.equal(seen.dialogs, 0);
        const found = await page.evaluate(() => ({
          overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth,
          scripts: document.scripts.length,
          images: [...document.images].map((image) => [image.alt, image.complete && image.naturalWidth > 0]),
          formulas: [...document.querySelectorAll('.equation math')].map((math) => [math.getAttribute('alttext'), math.getBoundingClientRect().height]),
          unnamed: [...document.images].filter((image) => !image.alt).length,
          headings: [...document.querySelectorAll('h1, h2')].map((heading) => heading.textContent),
          links: [...document.querySelectorAll('nav a')].map((link) => Boolean(document.querySelector(link.getAttribute('href')))),
        }));
        assert.ok(found.overflow <= 0, `${found.overflow} px stand over`);
        assert.equal(found.scripts, 0);
        assert.equal(found.unnamed, 0);
        for (const [alt, shown] of found.images) assert.ok(shown, alt);
        for (const [alt, height] of found.formulas) assert.ok(height > 8, alt);
        assert.ok(found.headings.length >= 4 && found.links.every(Boolean), found.headings.join());
        await close();
      });
    }

    test('text has contrast in light and dark', async () => {
      for (const colorScheme of ['light', 'dark']) {
        const { page, close } = await open(name, kind, { colorScheme });
        const least = await page.evaluate(() => {
          const light = (color) => {
            const [r, g, b] = color.match(/[\d.]+/g).map((part) => Number(part) / 255).map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
            return 0.2126 * r + 0.7152 * g + 0.0722 * b;
          };
          const ground = light(getComputedStyle(document.documentElement).backgroundColor);
          return Math.min(...[...document.querySelectorAll('h1, h2, p, td, th, a, dt, dd, figcaption')].map((node) => {
            const own = light(getComputedStyle(node).color);
            return (Math.max(own, ground) + 0.05) / (Math.min(own, ground) + 0.05);
          }));
        });
        assert.ok(least >= 4.5, `${colorScheme}: ${least}`);
        await close();
      }
    });

    if (kind === 'report') {
      test('its columns are those of summary.csv', async () => {
        const { page, close } = await open(name, kind);
        const section = page.locator('section', { has: page.locator('h2', { hasText: 'Columns of the results' }) });
        const shown = await section.locator('tbody tr').evaluateAll((trs) => trs.map((tr) => [...tr.cells].map((cell) => cell.textContent)));
        const [head, ...all] = parse(readFileSync(join(folder, name, 'summary.csv'), 'utf8'));
        const at = (column) => head.indexOf(column);
        assert.ok(shown.length > 5);
        shown.forEach(([column, least, largest, rms], k) => {
          // What nobody would see is shown as a replacement character.
          assert.equal(column, all[k][at('column')].replace(/(?![\t\n\r])[\p{Cc}\p{Cf}\u2028\u2029]/gu, '\ufffd'));
          for (const [text, exact] of [[least, 'min'], [largest, 'max'], [rms, 'rms']]) {
            const value = Number(all[k][at(exact)]);
            assert.ok(Math.abs(Number(text) - value) <= 1e-5 * Math.abs(value), `${column} ${exact}: ${text}, ${value}`);
          }
        });
        await close();
      });

      test('prints with all figures on pages', async (context) => {
        // Names of 10⁵ characters fill hundreds.
        if (name === 'hostile') return context.skip('its names fill too many pages');
        const { page, close } = await open(name, kind);
        await page.emulateMedia({ media: 'print' });
        assert.equal(await page.locator('nav').isVisible(), false);
        const pdf = await page.pdf({ format: 'A4' });
        const count = pdf.toString('latin1').match(/\/Type\s*\/Page\b/g)?.length ?? 0;
        assert.ok(count >= 2 && count < 60, `${count} pages`);
        await close();
      });
    }
  });
}
