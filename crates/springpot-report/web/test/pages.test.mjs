/**
 * Opens pages in a browser and uses them as a reader would. PAGES names a folder with NAME.html and, beside each, NAME/results.csv;
 * without it, pages are made from made-up data. BROWSER names the browser's program. What a page has not is left out.
 */

import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, readFileSync, readdirSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';
import { make, served } from './sample.mjs';

const FLAGS = ['--headless', '--no-sandbox', '--disable-gpu', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];
const folder = process.env.PAGES ? resolve(process.env.PAGES) : mkdtempSync(join(tmpdir(), 'pages-'));
if (!process.env.PAGES) make(folder);
const names = readdirSync(folder).filter((name) => name.endsWith('.html')).map((name) => name.slice(0, -5)).sort();
const has = (name) => names.includes(name);

/** @type {import('playwright-core').Browser} */
let browser;
before(async () => { browser = await chromium.launch({ executablePath: process.env.BROWSER || '/usr/bin/chromium', args: FLAGS }); });
after(() => browser?.close());

/** Opens a page and watches it. */
async function open(name, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 860 }, colorScheme: 'light', ...options });
  const page = await context.newPage();
  const seen = { errors: [], requests: [], dialogs: 0 };
  page.on('console', (message) => { if (message.type() === 'error') seen.errors.push(message.text()); });
  page.on('pageerror', (error) => seen.errors.push(String(error)));
  page.on('request', (request) => { if (!request.url().startsWith('data:')) seen.requests.push(request.url()); });
  page.on('dialog', (dialog) => { seen.dialogs++; dialog.dismiss(); });
  const address = pathToFileURL(join(folder, `${name}.html`)).href;
  await page.goto(address);
  await page.waitForFunction(() => document.documentElement.dataset.ready === 'true', null, { timeout: 60000 });
  return { page, seen, address, close: () => context.close() };
}

/** Rows of results.csv, case after case. @param {string} name */
function results(name) {
  const path = join(folder, name, 'results.csv');
  if (!existsSync(path)) return null;
  const [head, ...lines] = readFileSync(path, 'utf8').trim().split('\n');
  const columns = head.split(','), t = columns.indexOf('t'), cases = [[]];
  let last = -Infinity;
  for (const line of lines) {
    // Names of cases may be quoted; numbers have no commas.
    const cells = line.split(',').slice(-columns.length), row = cells.map((cell) => (cell === '' ? NaN : Number(cell)));
    if (row[t] < last) cases.push([]);
    last = row[t];
    cases[cases.length - 1].push(row);
  }
  return { columns, cases, t };
}

for (const name of names) {
  describe(name, () => {
    test('loads without errors and without the network', async () => {
      const { page, seen, address, close } = await open(name);
      await page.waitForTimeout(300);
      assert.deepEqual(seen.errors, []);
      assert.deepEqual(seen.requests, [address]);
      assert.equal(seen.dialogs, 0);
      assert.equal(await page.evaluate(() => window.springpot.webgl()), true);
      assert.equal(await page.locator('html').evaluate((node) => node.scrollWidth > node.clientWidth), false);
      const cases = await page.evaluate(() => window.springpot.data.cases.map((one) => one.status));
      if (cases.some((status) => status === 'done')) assert.equal(await page.locator('#error').isHidden(), true);
      await close();
    });

    test('the gripper follows the rows', async (context) => {
      const csv = results(name);
      const at = csv && ['x', 'y', 'z'].map((axis) => csv.columns.indexOf(`gripper.${axis}`));
      if (!csv || at.some((i) => i < 0)) return context.skip('no gripper in results.csv');
      const { page, close } = await open(name);
      const info = await page.evaluate(() => ({ rows: window.springpot.data.cases.map((one) => one.rows), bodies: window.springpot.data.scenes[0].bodies.map((body) => body.name), has: window.springpot.gripper(0) !== null }));
      if (!info.has) { await close(); return context.skip('no gripper in the scene'); }
      const all = csv.cases.flat(), span = (i) => { const v = all.map((row) => row[i]).filter(Number.isFinite); return Math.max(...v) - Math.min(...v); };
      const size = Math.max(0.1, ...at.map(span), ...at.map((i) => Math.max(...all.map((row) => Math.abs(row[i] || 0)))));
      let moved = 0;
      for (let c = 0; c < Math.min(info.rows.length, csv.cases.length); c++) {
        const rows = csv.cases[c];
        for (const share of [0, 0.13, 0.37, 0.5, 0.71, 1]) {
          const row = rows[Math.round(share * (rows.length - 1))];
          // The page may show every nth row: the shown time nearest to it is asked for.
          const shown = await page.evaluate(([i, t]) => {
            const one = window.springpot.data.cases[i], r = one.rowAt(t + 1e-7);
            window.springpot.seek(one.time[r]);
            return { t: one.time[r], p: window.springpot.gripper(i) };
          }, [c, row[csv.t]]);
          const same = rows.reduce((best, other) => (Math.abs(other[csv.t] - shown.t) < Math.abs(best[csv.t] - shown.t) ? other : best));
          if (at.some((i) => !Number.isFinite(same[i]))) continue;
          const off = Math.hypot(...at.map((i, k) => same[i] - shown.p[k]));
          assert.ok(off < 1e-5 * size, `case ${c}, t = ${shown.t}: off by ${off} of ${size}`);
        }
        moved += at.map((i) => Math.max(...rows.map((row) => row[i])) - Math.min(...rows.map((row) => row[i]))).reduce((a, b) => a + b, 0);
      }
      if (moved > 1e-6) {
        const places = await page.evaluate(() => {
          const { data, seek, body } = window.springpot, out = [];
          for (const share of [0, 0.33, 0.61]) {
            const one = data.cases[0];
            seek(one.time[Math.round(share * (one.rows - 1))]);
            out.push(data.scenes[one.scene].bodies.map((b) => body(0, b.name)), window.springpot.gripper(0));
          }
          return out.map((p) => JSON.stringify(p));
        });
        assert.ok(new Set(places).size > 2, 'bodies do not move');
      }
      return close();
    });

    test('the colour follows the force', async (context) => {
      const { page, close } = await open(name);
      const found = await page.evaluate(() => {
        const { data, seek, elementColor, setColorMode } = window.springpot, one = data.cases.find((each) => each.rows > 1), out = [];
        if (!one) return out;
        const index = data.cases.indexOf(one);
        for (const element of data.scenes[one.scene].elements) {
          const c = data.column(`${element.name}.force`);
          if (c < 0) continue;
          const force = Array.from(one.data[c].subarray(0, one.rows)), low = force.indexOf(Math.min(...force)), high = force.indexOf(Math.max(...force));
          const color = (row) => { seek(one.time[row]); return elementColor(index, element.name); };
          const zero = force.findIndex((v) => v === 0);
          setColorMode('force');
          const entry = { low: force[low], high: force[high], colors: [color(low), color(high)], zero: zero >= 0 ? color(zero) : null };
          setColorMode('stored');
          entry.stored = color(high);
          setColorMode('force');
          out.push(entry);
        }
        const peak = Math.max(...out.map((e) => Math.max(Math.abs(e.low), Math.abs(e.high))));
        return out.map((e) => ({ ...e, peak }));
      });
      if (!found.length) { await close(); return context.skip('no element with a force'); }
      for (const { low, high, colors, zero, stored, peak } of found) {
        for (const color of [...colors, stored]) assert.match(color, /^#[0-9a-f]{6}$/);
        if (high - low > 0.05 * peak) assert.notEqual(colors[0], colors[1]);
        if (zero) {
          const [r, g, b] = [1, 3, 5].map((i) => parseInt(zero.slice(i, i + 2), 16));
          assert.ok(Math.max(r, g, b) - Math.min(r, g, b) < 20, `no force is ${zero}, not grey`);
        }
      }
      return close();
    });

    test('keys do what the help says', async () => {
      const { page, seen, close } = await open(name);
      const ask = (what) => page.evaluate((key) => { const s = window.springpot; return { time: s.time(), row: s.row(), playing: s.playing(), shown: s.shown(), mode: s.colorMode(), beside: s.beside(), dark: s.dark(), speed: s.speed(), camera: s.camera() }[key]; }, what);
      const info = await page.evaluate(() => { const { data, shown } = window.springpot, one = data.cases[shown()[0]]; return { rows: one.rows, end: Math.max(...shown().map((i) => data.cases[i].end)), own: one.end, cases: data.cases.length }; });
      await page.locator('h1').click();
      await page.keyboard.press('Home');
      assert.equal(await ask('row'), 0);
      assert.equal(await ask('playing'), false, 'nothing plays by itself');
      if (info.rows > 25) {
        await page.keyboard.press('ArrowRight');
        assert.equal(await ask('row'), 1);
        await page.keyboard.press('Shift+ArrowRight');
        assert.equal(await ask('row'), 11);
        await page.keyboard.press('ArrowLeft');
        assert.equal(await ask('row'), 10);
        await page.keyboard.press('Shift+ArrowLeft');
        assert.equal(await ask('row'), 0);
        await page.keyboard.press(' ');
        assert.equal(await ask('playing'), true);
        await page.waitForFunction(() => window.springpot.time() > window.springpot.data.cases[window.springpot.shown()[0]].start);
        await page.keyboard.press(' ');
        assert.equal(await ask('playing'), false);
      }
      await page.keyboard.press('End');
      assert.ok(Math.abs((await ask('time')) - info.end) < 1e-5);
      const speed = await ask('speed');
      await page.keyboard.press('-');
      assert.ok((await ask('speed')) < speed);
      await page.keyboard.press('+');
      assert.equal(await ask('speed'), speed);
      await page.keyboard.press('c');
      assert.equal(await ask('mode'), 'stored');
      await page.keyboard.press('c');
      assert.equal(await ask('mode'), 'force');
      if (info.cases > 1) {
        const shown = await ask('shown');
        await page.keyboard.press('2');
        assert.equal((await ask('shown')).includes(1), !shown.includes(1));
        await page.keyboard.press('2');
        assert.deepEqual(await ask('shown'), shown);
        await page.keyboard.press('g');
        assert.equal(await ask('beside'), true);
        await page.keyboard.press('g');
        assert.equal(await ask('beside'), false);
      }
      const light = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
      await page.keyboard.press('l');
      assert.equal(await ask('dark'), true);
      assert.notEqual(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), light);
      await page.keyboard.press('l');
      assert.equal(await ask('dark'), false);
      await page.keyboard.press('r');
      const camera = await ask('camera');
      await page.evaluate(() => window.springpot.turn(0.7, 0.2));
      assert.notDeepEqual(await ask('camera'), camera);
      await page.keyboard.press('r');
      await page.waitForTimeout(100);
      (await ask('camera')).forEach((v, k) => assert.ok(Math.abs(v - camera[k]) < 1e-3 * (1 + Math.abs(v))));
      await page.keyboard.press('?');
      assert.equal(await page.locator('#help').evaluate((node) => node.open), true);
      assert.ok((await page.locator('#help-keys tr').count()) >= 10);
      await page.keyboard.press('Escape');
      assert.equal(await page.locator('#help').evaluate((node) => node.open), false);
      // While someone types, keys are text.
      await page.locator('.plot header button, .add').first().click();
      await page.locator('#picker-search').fill('');
      await page.locator('#picker-search').pressSequentially('lc1');
      assert.equal(await ask('dark'), false);
      assert.equal(await ask('mode'), 'force');
      await page.keyboard.press('Escape');
      assert.deepEqual(seen.errors, []);
      await close();
    });

    test('plots show values, zoom, move and seek', async (context) => {
      const { page, seen, close } = await open(name);
      if (!(await page.locator('.plot').count())) { await close(); return context.skip('no plots'); }
      const first = page.locator('.plot').first(), canvas = first.locator('canvas.over');
      const ask = () => page.evaluate(() => ({ plot: window.springpot.plots()[0], time: window.springpot.time(), t: window.springpot.data.column('t') }));
      await page.waitForTimeout(300);
      const start = await ask(), box = await canvas.boundingBox(), f = start.plot.frame;
      const x = box.x + f.left + 0.4 * f.width, y = box.y + f.top + 0.5 * f.height;
      await page.mouse.move(x, y);
      assert.equal(await first.locator('.tip').isVisible(), true);
      assert.ok((await first.locator('.tip').textContent()).length > 3);
      if (start.plot.x === start.t) {
        await page.mouse.click(x, y);
        const { time } = await ask(), want = f.x0 + 0.4 * (f.x1 - f.x0);
        assert.ok(Math.abs(time - want) < 0.02 * (f.x1 - f.x0), `sought ${want}, got ${time}`);
      }
      await page.mouse.wheel(0, -400);
      await page.waitForTimeout(250);
      const zoomed = await ask();
      assert.ok(zoomed.plot.zoomed && zoomed.plot.frame.x1 - zoomed.plot.frame.x0 < 0.9 * (f.x1 - f.x0));
      await page.keyboard.down('Shift');
      await page.mouse.down();
      await page.mouse.move(x + 40, y);
      await page.mouse.up();
      await page.keyboard.up('Shift');
      await page.waitForTimeout(250);
      assert.ok((await ask()).plot.frame.x0 < zoomed.plot.frame.x0);
      await page.mouse.dblclick(x, y);
      await page.waitForTimeout(250);
      assert.equal((await ask()).plot.zoomed, false);
      assert.match((await first.locator('canvas').first().getAttribute('aria-label')) ?? '', /^Plot over/);
      // A plot more, and one less.
      const count = await page.locator('.plot').count();
      await page.locator('.add').click();
      await page.locator('#picker-search').fill('gripper.z');
      if (await page.locator('#picker-list input').count()) {
        await page.locator('#picker-list input').first().check();
        await page.locator('#picker .strong').click();
        await page.waitForFunction((n) => window.springpot.plots().length === n, count + 1, { timeout: 5000 });
        await page.locator('.plot').last().locator('button').nth(1).click();
        await page.waitForFunction((n) => window.springpot.plots().length === n, count, { timeout: 5000 });
      } else await page.keyboard.press('Escape');
      assert.deepEqual(seen.errors, []);
      return close();
    });

    test('cases and elements can be chosen', async () => {
      const { page, close } = await open(name);
      const { cases, elements } = await page.evaluate(() => ({ cases: window.springpot.data.cases.length, elements: window.springpot.data.scenes[0]?.elements.map((each) => each.name) ?? [] }));
      if (cases > 1) {
        const boxes = page.locator('#cases input');
        assert.equal(await boxes.count(), cases);
        await page.locator('#cases-none').click();
        assert.equal((await page.evaluate(() => window.springpot.shown())).length, 1);
        await boxes.nth(1).check();
        assert.equal((await page.evaluate(() => window.springpot.shown())).includes(1), true);
        await page.locator('#cases-all').click();
        const shown = await page.evaluate(() => window.springpot.shown());
        assert.equal(shown.length, Math.min(cases, 12));
        await page.locator('#layout [value=beside]').click();
        assert.equal(await page.locator('#labels .case-name.placed').count(), shown.length);
        await page.locator('#cases .pick').nth(1).click();
        assert.equal((await page.evaluate(() => window.springpot.shown()))[0], 1);
      }
      if (elements.length) {
        await page.locator('#elements button').last().click();
        assert.equal(await page.locator('#elements button[aria-pressed=true]').count(), 1);
        assert.ok((await page.locator('#element .law').count()) >= 1);
        await page.evaluate((element) => window.springpot.select(element), elements[0]);
        assert.equal(await page.evaluate(() => window.springpot.selected()), elements[0]);
      }
      await close();
    });

    test('a phone shows all of it', async () => {
      const { page, seen, close } = await open(name, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
      await page.waitForTimeout(200);
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth && document.querySelector('main').scrollWidth <= innerWidth), true);
      await page.evaluate(() => document.querySelector('main').scrollTo(0, 1e6));
      await page.waitForTimeout(100);
      const play = await page.locator('#play').boundingBox();
      assert.ok(play.y >= 0 && play.y + play.height <= 844, 'play is out of reach');
      await page.locator('#play').tap();
      assert.equal(await page.evaluate(() => window.springpot.playing() || window.springpot.data.cases[0].rows < 2), true);
      assert.deepEqual(seen.errors, []);
      await close();
    });
  });
}

describe('all pages', () => {
  test('hostile names are text', { skip: !has('hostile') }, async () => {
    const { page, seen, close } = await open('hostile');
    await page.locator('#mode [value=stored]').click();
    await page.locator('.plot header button').first().click();
    await page.keyboard.press('Escape');
    assert.ok((await page.locator('body').innerText()).includes('<script>'));
    assert.equal(await page.locator('img').count(), 0);
    assert.equal(await page.locator('script').count(), 2);
    assert.equal(seen.dialogs, 0);
    assert.deepEqual(seen.errors, []);
    const bar = await page.locator('#bar').boundingBox();
    assert.ok(bar.height < 70, 'the title breaks the layout');
    const long = await page.evaluate(() => Math.max(...[...document.querySelectorAll('[title]')].map((node) => node.getAttribute('title').length)));
    assert.ok(long <= 220);
    await close();
  });

  test('a frame of the humanoid takes at most 8 ms of script', { skip: !has('humanoid') }, async (context) => {
    const { page, close } = await open('humanoid');
    await page.evaluate(() => { window.springpot.play(); });
    await page.waitForTimeout(1500);
    await page.evaluate(() => window.springpot.clearFrame());
    await page.waitForFunction(() => window.springpot.frame().count > 40, null, { timeout: 60000 });
    const frame = await page.evaluate(() => window.springpot.frame());
    context.diagnostic(`script per frame: mean ${frame.scriptMs.mean} ms, 95 % ${frame.scriptMs.p95} ms, most ${frame.scriptMs.max} ms; ${frame.fps} frames per second, ${frame.count} frames`);
    assert.ok(frame.scriptMs.mean <= 8, `${frame.scriptMs.mean} ms`);
    await close();
  });

  test('without WebGL the rest works', async () => {
    const other = await chromium.launch({ executablePath: process.env.BROWSER || '/usr/bin/chromium', args: [...FLAGS.filter((flag) => !/angle|swiftshader/.test(flag)), '--disable-3d-apis'] });
    const page = await (await other.newContext()).newPage();
    await page.goto(pathToFileURL(join(folder, `${names[0]}.html`)).href);
    await page.waitForFunction(() => document.documentElement.dataset.ready === 'true', null, { timeout: 60000 });
    assert.equal(await page.evaluate(() => window.springpot.webgl()), false);
    assert.equal(await page.locator('#nogl').isVisible(), true);
    await page.keyboard.press('End');
    assert.ok((await page.evaluate(() => window.springpot.time())) > 0);
    assert.ok((await page.locator('.plot').count()) > 0);
    await other.close();
  });

  test('a served page grows with its run', async () => {
    const { html, messages, first } = served();
    let send = () => {}, asked = 0;
    const server = createServer((request, response) => {
      if (request.url === '/events') {
        asked++;
        response.writeHead(200, { 'content-type': 'text/event-stream' });
        send = (message) => response.write(`data: ${JSON.stringify(message)}\n\n`);
        request.on('close', () => response.end());
      } else response.writeHead(200, { 'content-type': 'text/html; charset=utf-8' }).end(html);
    });
    await new Promise((done) => server.listen(0, '127.0.0.1', done));
    const context = await browser.newContext(), page = await context.newPage(), errors = [];
    page.on('console', (message) => { if (message.type() === 'error') errors.push(message.text()); });
    page.on('pageerror', (error) => errors.push(String(error)));
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    await page.waitForFunction(() => document.documentElement.dataset.ready === 'true');
    assert.equal(await page.locator('#live').getAttribute('aria-pressed'), 'true');
    for (const message of messages.slice(0, 4)) {
      await page.waitForTimeout(150);
      send(message);
    }
    await page.waitForFunction(() => window.springpot.data.cases[0].rows === 200);
    await page.waitForFunction((t) => Math.abs(window.springpot.time() - t) < 1e-5, first.table[199][0]);
    await page.locator('#time').focus();
    await page.keyboard.press('Home');
    assert.equal(await page.locator('#live').getAttribute('aria-pressed'), 'false');
    for (const message of messages.slice(4)) send(message);
    await page.waitForFunction(() => document.querySelector('#status').textContent === 'done');
    assert.equal(await page.evaluate(() => window.springpot.data.cases.length), 2);
    assert.equal(await page.evaluate(() => window.springpot.data.cases[1].rows), 120);
    assert.equal(await page.evaluate(() => window.springpot.time()), 0);
    await page.waitForTimeout(500);
    assert.equal(asked, 1, 'the source was asked again after its end');
    assert.deepEqual(errors, []);
    await context.close();
    server.closeAllConnections();
    server.close();
  });

  test('a reader who wants no motion gets none', async () => {
    const { page, close } = await open(names[0], { reducedMotion: 'reduce', colorScheme: 'dark' });
    await page.waitForTimeout(300);
    assert.equal(await page.evaluate(() => window.springpot.playing()), false);
    assert.equal(await page.evaluate(() => window.springpot.dark()), true);
    await close();
  });
});
