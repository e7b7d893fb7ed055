/**
 * Opens pages in a browser and uses them as a reader would. PAGES names a folder with NAME.html and, beside each, NAME/results.csv;
 * without it, pages are made from made-up data. BROWSER names the browser's program. What a page has not is left out.
 */

import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, readFileSync, readdirSync, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';
import { parse } from './csv.mjs';
import { make, served } from './sample.mjs';

// Smooth edges double what a frame costs without a graphics card.
const FLAGS = ['--headless', '--no-sandbox', '--disable-gpu', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--webgl-antialiasing-mode=none'];
/** Largest page, bytes. */
const MOST = 10e6;
const folder = process.env.PAGES ? resolve(process.env.PAGES) : mkdtempSync(join(tmpdir(), 'pages-'));
if (!process.env.PAGES) make(folder);
const names = readdirSync(folder).filter((name) => name.endsWith('.html')).map((name) => name.slice(0, -5)).sort();
const has = (name) => names.includes(name);
if (!names.length) throw new Error(`${folder} holds no pages`);

/** @type {import('playwright-core').Browser} */
let browser;
before(async () => { browser = await chromium.launch({ executablePath: process.env.BROWSER || '/usr/bin/chromium', args: FLAGS }); });
after(() => browser?.close());

/** Opens a page and watches it. Where pictures are not looked at, fewer pixels spare a machine without a graphics card. */
async function open(name, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 860 }, colorScheme: 'light', ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(30000);
  const seen = { errors: [], requests: [], dialogs: 0 };
  page.on('console', (message) => { if (message.type() === 'error') seen.errors.push(message.text()); });
  page.on('pageerror', (error) => seen.errors.push(String(error)));
  page.on('request', (request) => { if (!request.url().startsWith('data:')) seen.requests.push(request.url()); });
  page.on('dialog', (dialog) => { seen.dialogs++; dialog.dismiss(); });
  const address = pathToFileURL(join(folder, `${name}.html`)).href;
  await page.goto(address);
  await page.waitForFunction(() => document.documentElement.dataset.ready === 'true', null, { timeout: 60000 });
  return { page, seen, address, context, close: () => context.close() };
}

/** Rows of results.csv, case after case. @param {string} name */
function results(name) {
  const path = join(folder, name, 'results.csv');
  if (!existsSync(path)) return null;
  const [columns, ...lines] = parse(readFileSync(path, 'utf8')), t = columns.indexOf('t'), cases = [[]];
  let last = -Infinity;
  for (const cells of lines) {
    const row = cells.map((cell) => (cell === '' ? NaN : Number(cell)));
    if (row[t] < last) cases.push([]);
    last = row[t];
    cases[cases.length - 1].push(row);
  }
  return { columns, cases, t };
}

/** A number as the page writes it. @param {string} text */
function read(text) {
  const m = /^([−-]?[\d.]+)(?:·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?/.exec(text.trim());
  if (!m) return NaN;
  const power = (m[2] ?? '').replace(/./g, (c) => (c === '⁻' ? '-' : String('⁰¹²³⁴⁵⁶⁷⁸⁹'.indexOf(c))));
  return Number(`${m[1].replace('−', '-')}e${power || 0}`);
}

/** Written numbers have few digits: three of them before a power of ten. @param {string} text @param {number} value */
const near = (text, value, digits = text.includes('·10') ? 6e-3 : 1e-3) => Math.abs(read(text) - value) <= digits * Math.abs(value) + 1e-30;

/** The next frame is drawn. */
const drawn = (page) => page.waitForFunction(() => window.springpot.drawn() === window.springpot.time());

/** Everything that can be worked has a name for those who do not see it, and so has every picture. */
async function named(context, page) {
  const session = await context.newCDPSession(page);
  const { nodes } = await session.send('Accessibility.getFullAXTree');
  await session.detach();
  const roles = new Set(['button', 'checkbox', 'combobox', 'dialog', 'image', 'img', 'link', 'listbox', 'radio', 'region', 'searchbox', 'slider', 'splitter', 'switch', 'tab', 'textbox']);
  const found = nodes.filter((node) => !node.ignored && roles.has(node.role?.value));
  const bare = found.filter((node) => !node.name?.value?.trim());
  assert.deepEqual(bare.map((node) => `${node.role.value} ${JSON.stringify(node.properties ?? [])}`), [], 'controls without a name');
  return found.map((node) => ({ role: node.role.value, name: node.name.value, focusable: (node.properties ?? []).some((p) => p.name === 'focusable' && p.value.value) }));
}

/** Texts that stand out too little from what is behind them. Large or bold ones may by 3, others by 4.5. */
const faint = (page) => page.evaluate(() => {
  const rgba = (text) => { const v = text.match(/[\d.]+/g).map(Number); return v.length < 4 ? [...v, 1] : v; };
  const light = (c) => { const [r, g, b] = c.map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4)); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const behind = (node) => {
    const layers = [];
    for (let n = node; n; n = n.parentElement) layers.push(rgba(getComputedStyle(n).backgroundColor));
    return layers.reverse().reduce((under, [r, g, b, a]) => [r, g, b].map((v, k) => a * v + (1 - a) * under[k]), [255, 255, 255]);
  };
  const out = [];
  const nodes = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (nodes.nextNode()) {
    const node = nodes.currentNode.parentElement, text = nodes.currentNode.textContent.trim();
    if (!text || !node.checkVisibility({ visibilityProperty: true, opacityProperty: true }) || node.closest('script, style, noscript, .hidden, .skip, :disabled, #view')) continue;
    const style = getComputedStyle(node), back = behind(node), [r, g, b, a] = rgba(style.color), ink = [r, g, b].map((v, k) => a * v + (1 - a) * back[k]);
    const [high, low] = [light(ink), light(back)].sort((x, y) => y - x), ratio = (high + 0.05) / (low + 0.05);
    const size = parseFloat(style.fontSize), large = size >= 24 || (size >= 18.6 && Number(style.fontWeight) >= 700);
    if (ratio < (large ? 3 : 4.5)) out.push(`${ratio.toFixed(2)} of "${text.slice(0, 30)}" in ${node.tagName}.${node.className}`);
  }
  return [...new Set(out)];
});

// A page waits for its frames most of the time: two at once.
describe('each page', { concurrency: 2 }, () => {
  for (const name of names) describe(name, { concurrency: 1 }, () => {
    /** One page for tests that leave it as it was; a failure gets the next one a new page. @type {Awaited<ReturnType<typeof open>>|null} */
    let shared = null;
    const check = (what, run) => test(what, async (context) => {
      shared ??= await open(name, { deviceScaleFactor: 0.5, reducedMotion: 'reduce' });
      try {
        await run(shared.page, context, shared);
        assert.deepEqual(shared.seen.errors, []);
        assert.equal(shared.seen.dialogs, 0);
      } catch (error) {
        await shared.close().catch(() => {});
        shared = null;
        throw error;
      }
    });
    after(() => shared?.close());

    check('loads without errors and without the network', async (page, context, { seen, address }) => {
      await page.waitForTimeout(300);
      const size = statSync(join(folder, `${name}.html`)).size;
      assert.ok(size < MOST, `${size} bytes`);
      context.diagnostic(`${name}: ${Math.round(size / 1000)} kB`);
      assert.deepEqual(seen.requests, [address]);
      assert.equal(await page.evaluate(() => window.springpot.webgl()), true);
      assert.equal(await page.locator('html').evaluate((node) => node.scrollWidth > node.clientWidth), false);
      const cases = await page.evaluate(() => window.springpot.data.cases.map((one) => one.status));
      if (cases.some((status) => status === 'done')) assert.equal(await page.locator('#error').isHidden(), true);
    });

    check('the gripper and the elements are where the rows say', async (page, context) => {
      const csv = results(name);
      if (!csv) return context.skip('no results.csv');
      const at = ['x', 'y', 'z'].map((axis) => csv.columns.indexOf(`gripper.${axis}`));
      const info = await page.evaluate(() => ({
        times: window.springpot.data.cases.map((one) => Array.from(one.time)), gripper: window.springpot.gripper(0) !== null,
        elements: window.springpot.data.scenes[0].elements.filter((element) => element.shape.points).map((element) => element.name),
      }));
      const gripper = info.gripper && at.every((i) => i >= 0), lengths = info.elements.map((element) => csv.columns.indexOf(`${element}.length`));
      if (!gripper && !lengths.length) return context.skip('neither a gripper nor elements between points');
      const all = csv.cases.flat(), most = (columns) => columns.reduce((best, i) => all.reduce((b, row) => Math.max(b, Math.abs(row[i]) || 0), best), 0.1);
      const size = most(gripper ? at : lengths);
      const places = new Set();
      for (let c = 0; c < Math.min(info.times.length, csv.cases.length); c++) {
        const rows = csv.cases[c], times = info.times[c];
        // The page may show every so many rows.
        const asked = [0, 0.13, 0.37, 0.5, 0.71, 1].map((share) => times[Math.round(share * (times.length - 1))]);
        const shown = await page.evaluate(([i, list, elements]) => list.map((t) => {
          window.springpot.seek(t);
          return { p: window.springpot.gripper(i), lines: elements.map((element) => window.springpot.line(i, element)) };
        }), [c, asked, info.elements]);
        asked.forEach((t, n) => {
          const same = rows.reduce((best, other) => (Math.abs(other[csv.t] - t) < Math.abs(best[csv.t] - t) ? other : best)), { p, lines } = shown[n];
          assert.ok(Math.abs(same[csv.t] - t) <= 1e-6 * (1 + t), `case ${c} has no row at ${t}`);
          if (gripper && at.every((i) => Number.isFinite(same[i]))) {
            const off = Math.hypot(...at.map((i, k) => same[i] - p[k]));
            assert.ok(off < 1e-5 * size, `case ${c}, t = ${t}: the gripper is off by ${off} of ${size}`);
          }
          lengths.forEach((column, e) => {
            const line = lines[e];
            if (!(column >= 0) || !Number.isFinite(same[column])) return;
            let length = 0;
            for (let k = 3; k < line.length; k += 3) length += Math.hypot(line[k] - line[k - 3], line[k + 1] - line[k - 2], line[k + 2] - line[k - 1]);
            assert.ok(Math.abs(length - same[column]) < 1e-5 * size, `case ${c}, t = ${t}: ${info.elements[e].slice(0, 40)} is ${length} long, not ${same[column]}`);
          });
          places.add(JSON.stringify([p, lines]));
        });
      }
      assert.ok(places.size > 2, 'nothing moves');
      await page.evaluate(() => window.springpot.seek(0));
      return undefined;
    });

    check('the slider moves the robot', async (page, context) => {
      const rows = await page.evaluate(() => { const { data, shown } = window.springpot; return data.cases[shown()[0]]?.rows ?? 0; });
      if (rows < 2) return context.skip('no rows');
      const box = await page.locator('#time').boundingBox(), csv = results(name), at = csv && ['x', 'y', 'z'].map((axis) => csv.columns.indexOf(`gripper.${axis}`));
      let before = -1;
      for (const share of [0.25, 0.5, 0.75]) {
        await page.mouse.click(box.x + share * box.width, box.y + box.height / 2);
        await drawn(page);
        const now = await page.evaluate(() => {
          const s = window.springpot, one = s.data.cases[s.shown()[0]], [start, end] = [one.start, one.end];
          return { t: s.time(), share: (s.time() - start) / (end - start), first: s.shown()[0], gripper: s.drawnGripper(s.shown()[0]), text: document.querySelector('#clock').textContent, value: document.querySelector('#time').getAttribute('aria-valuetext') };
        });
        assert.ok(now.t > before, `the slider at ${share} is at ${now.t}`);
        before = now.t;
        assert.ok(near(now.text, now.t, 0.02), `the clock says ${now.text} at ${now.t}`);
        assert.match(now.value, /row \d+ of \d+/);
        const line = csv?.cases[now.first];
        if (!at || at.some((i) => i < 0) || !line) continue;
        // What is drawn, between two rows.
        const i = Math.max(line.findIndex((row) => row[csv.t] > now.t), 1), reach = Math.max(...at.map((k) => Math.max(...line.map((row) => Math.abs(row[k]) || 0))));
        const off = Math.hypot(...at.map((k, n) => { const s = (now.t - line[i - 1][csv.t]) / (line[i][csv.t] - line[i - 1][csv.t]); return line[i - 1][k] + s * (line[i][k] - line[i - 1][k]) - now.gripper[n]; }));
        assert.ok(off < 0.01 * reach, `drawn ${off} m away from the rows at ${now.t}`);
      }
      await page.evaluate(() => window.springpot.seek(0));
      return undefined;
    });

    check('the colour follows the force', async (page, context) => {
      const found = await page.evaluate(() => {
        const { data, seek, elementColor, setColorMode, shown } = window.springpot, out = [], most = new Map();
        const list = shown().flatMap((i) => data.scenes[data.cases[i].scene].elements.map((element) => {
          const c = data.column(`${element.name}.force`), one = data.cases[i], force = c < 0 ? [] : Array.from(one.data[c].subarray(0, one.rows));
          let low = -1, high = -1, zero = -1;
          force.forEach((v, r) => {
            if (!Number.isFinite(v)) return;
            if (low < 0 || v < force[low]) low = r;
            if (high < 0 || v > force[high]) high = r;
            if (v === 0 && zero < 0) zero = r;
          });
          const unit = data.columns[c]?.unit;
          if (low >= 0) most.set(unit, Math.max(most.get(unit) ?? 0, -force[low], force[high]));
          return { i, one, name: element.name, force, low, high, zero, unit };
        }).filter(({ low }) => low >= 0));
        for (const { i, one, name, force, low, high, zero, unit } of list) {
          const color = (row) => { seek(one.time[row]); return elementColor(i, name); };
          setColorMode('force');
          const entry = { name: name.slice(0, 40), low: force[low], high: force[high], most: most.get(unit), colors: [color(low), color(high)], zero: zero >= 0 ? color(zero) : null };
          setColorMode('stored');
          out.push({ ...entry, stored: color(high) });
        }
        setColorMode('force');
        seek(0);
        return out;
      });
      if (!found.length) return context.skip('no element with a force');
      const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
      let changes = 0;
      // One range for all shown cases and elements of a unit: what hardly takes part in it may stay grey.
      for (const { name: element, low, high, colors, zero, stored, most } of found) {
        for (const color of [...colors, stored]) assert.match(color, /^#[0-9a-f]{6}$/);
        if (high - low > 0.05 * most) {
          changes++;
          assert.notEqual(colors[0], colors[1], `${element} from ${low} to ${high} of ${most}`);
        }
        for (const [force, color] of [[low, colors[0]], [high, colors[1]]]) {
          if (Math.abs(force) < 0.3 * most) continue;
          const [r, , b] = rgb(color);
          assert.ok(force > 0 ? r > b : b > r, `${element}: ${force} of ${most} is ${color}`);
        }
        if (zero) assert.ok(Math.max(...rgb(zero)) - Math.min(...rgb(zero)) < 20, `no force is ${zero}, not grey`);
      }
      return changes ? undefined : context.skip('no force changes by a twentieth of the range');
    });

    check('keys do what the help says', async (page) => {
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
      await page.keyboard.press('+');
      assert.ok((await ask('speed')) > speed);
      await page.keyboard.press('-');
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
      await page.keyboard.press('a');
      await page.keyboard.press('w');
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
      await page.locator('#picker footer .shut').click();
      await page.locator('h1').click();
      await page.keyboard.press('Home');
    });

    check('plots show values, zoom, move and seek', async (page, context) => {
      if (!(await page.locator('.plot').count())) return context.skip('no plots');
      const first = page.locator('.plot').first(), canvas = first.locator('canvas.over');
      const ask = () => page.evaluate(() => ({ plot: window.springpot.plots()[0], time: window.springpot.time(), t: window.springpot.data.column('t') }));
      await page.waitForFunction(() => window.springpot.plots().every((plot) => plot.frame.width > 1));
      const start = await ask(), box = await canvas.boundingBox(), f = start.plot.frame;
      const x = box.x + f.left + 0.4 * f.width, y = box.y + f.top + 0.5 * f.height;
      await page.mouse.move(x, y);
      assert.equal(await first.locator('.tip').isVisible(), true);
      if (start.plot.x === start.t) {
        // What the pointer shows is in the rows.
        const said = await first.locator('.tip').evaluate((node) => ({ at: node.querySelector('.at').textContent, values: [...node.querySelectorAll('b')].map((b) => b.textContent) }));
        const t = f.x0 + 0.4 * (f.x1 - f.x0), written = read(said.at.replace(/^t = /, ''));
        assert.ok(Math.abs(written - t) < 0.01 * (f.x1 - f.x0), `${said.at} at ${t}`);
        const values = await page.evaluate(([at, ys]) => {
          const { data, shown } = window.springpot;
          return shown().map((i) => data.cases[i]).filter((one) => one.rows && at >= one.start && at <= one.end).flatMap((one) => ys.map((c) => { const r = one.rowAt(at), list = one.data[c].subarray(Math.max(r - 2, 0), r + 4); return [Math.min(...list), Math.max(...list)]; }));
        }, [t, start.plot.ys]);
        values.slice(0, said.values.length).forEach(([low, high], k) => {
          if (!Number.isFinite(low + high)) return;
          const v = read(said.values[k]), room = 6e-3 * Math.max(Math.abs(low), Math.abs(high)) + 1e-30;
          assert.ok(v >= low - room && v <= high + room, `the tip says ${said.values[k]}, the rows ${low} … ${high}`);
        });
        await page.mouse.click(x, y);
        const { time } = await ask();
        assert.ok(Math.abs(time - t) < 0.02 * (f.x1 - f.x0), `sought ${t}, got ${time}`);
      }
      await page.mouse.wheel(0, -400);
      await page.waitForFunction(() => window.springpot.plots()[0].zoomed);
      await page.waitForTimeout(150);
      const zoomed = await ask();
      assert.ok(zoomed.plot.frame.x1 - zoomed.plot.frame.x0 < 0.9 * (f.x1 - f.x0));
      await page.keyboard.down('Shift');
      await page.mouse.down();
      await page.mouse.move(x + 40, y);
      await page.mouse.up();
      await page.keyboard.up('Shift');
      await page.waitForTimeout(150);
      assert.ok((await ask()).plot.frame.x0 < zoomed.plot.frame.x0);
      await page.mouse.dblclick(x, y);
      await page.waitForTimeout(150);
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
      } else await page.locator('#picker footer .shut').click();
      return undefined;
    });

    check('the loop of force over stroke is hovered and sought along its curve', async (page, context) => {
      await page.waitForFunction(() => window.springpot.plots().every((plot) => plot.frame.width > 1));
      const found = await page.evaluate(() => {
        const { data, plots, shown } = window.springpot, t = data.column('t'), k = plots().findIndex((plot) => plot.x >= 0 && plot.x !== t), plot = plots()[k];
        if (!plot) return null;
        // A case may be without the element.
        const one = shown().map((i) => data.cases[i]).find((each) => each.data[plot.x].some(Number.isFinite));
        const row = Math.round(0.6 * (one.rows - 1)), f = plot.frame, x = one.data[plot.x][row], y = one.data[plot.ys[0]][row];
        return { k, names: [data.columns[plot.x].name, data.columns[plot.ys[0]].name], px: f.left + ((x - f.x0) / (f.x1 - f.x0)) * f.width, py: f.top + ((f.y1 - y) / (f.y1 - f.y0)) * f.height };
      });
      if (!found) return context.skip('no element with force and stroke');
      assert.match(found.names[0], /\.stroke$/);
      assert.match(found.names[1], /\.force$/);
      const plot = page.locator('.plot').nth(found.k), canvas = plot.locator('canvas.over');
      await canvas.scrollIntoViewIfNeeded();
      const box = await canvas.boundingBox();
      await page.mouse.move(box.x + found.px, box.y + found.py);
      assert.equal(await plot.locator('.tip').isVisible(), true);
      assert.match(await plot.locator('.tip').textContent(), /^t = /);
      await page.mouse.click(box.x + found.px, box.y + found.py);
      // Several cases may cross there: the row that is sought lies under the pointer in one of them.
      const off = await page.evaluate(([k, x, y]) => {
        const { data, plots, shown, time } = window.springpot, plot = plots()[k], f = plot.frame;
        return Math.min(...shown().map((i) => data.cases[i]).map((one) => {
          const r = one.rowAt(time() + 1e-9), px = f.left + ((one.data[plot.x][r] - f.x0) / (f.x1 - f.x0)) * f.width, py = f.top + ((f.y1 - one.data[plot.ys[0]][r]) / (f.y1 - f.y0)) * f.height;
          return Math.hypot(px - x, py - y);
        }).filter(Number.isFinite));
      }, [found.k, found.px, found.py]);
      assert.ok(off < 3, `the row lies ${off} pixels beside`);
      await page.evaluate(() => window.springpot.seek(0));
      return undefined;
    });

    check('elements at one sliding joint stand one beside another, from wall to body', async (page, context) => {
      const lanes = await page.evaluate(() => {
        const { data, seek, line, shown } = window.springpot, found = new Map();
        for (const { name, shape } of data.scenes[0]?.elements ?? []) if (shape.joint && !shape.joint.turns) found.set(shape.joint.body, [...(found.get(shape.joint.body) ?? []), name]);
        const at = [...found.values()].map((names) => [0, 0.37, 1].map((share) => {
          seek(share * data.cases[shown()[0]].end);
          return names.map((name) => line(shown()[0], name));
        }));
        seek(0);
        return at;
      });
      if (!lanes.length) return context.skip('no element at a sliding joint');
      for (const lines of lanes.flat()) {
        const along = lines.map(([a, b, c, x, y, z]) => [x - a, y - b, z - c]), length = along.map((d) => Math.hypot(...d));
        for (let i = 0; i < lines.length; i++) {
          assert.ok(length[i] > 1e-4 && Number.isFinite(length[i]), `element ${i} has the length ${length[i]}`);
          for (let j = 0; j < i; j++) {
            // The distance of two parallel lines.
            const to = [0, 1, 2].map((k) => lines[j][k] - lines[i][k]), dot = [0, 1, 2].reduce((sum, k) => sum + to[k] * along[i][k], 0) / length[i];
            const apart = Math.sqrt(Math.max(to.reduce((sum, v) => sum + v * v, 0) - dot * dot, 0));
            assert.ok(apart > 0.1 * length[i], `elements ${i} and ${j} are ${apart} apart at lengths of ${length[i]}`);
          }
        }
      }
      return undefined;
    });

    check('cases and elements can be chosen, and their values are those of the rows', async (page) => {
      const { cases, elements } = await page.evaluate(() => ({ cases: window.springpot.data.cases.length, elements: window.springpot.data.scenes[0]?.elements.map((each) => each.name) ?? [] }));
      const first = await page.evaluate(() => window.springpot.shown());
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
        await page.locator('#layout [value=overlay]').click();
        await page.locator('#cases .pick').nth(1).click();
        assert.equal((await page.evaluate(() => window.springpot.shown()))[0], 1);
        await page.locator('#cases .pick').nth(0).click();
        // As many as at first.
        for (let i = 0; i < cases; i++) if (!first.includes(i) && shown.includes(i)) await boxes.nth(i).uncheck();
      }
      if (elements.length) {
        await page.locator('#elements button').last().click();
        assert.equal(await page.locator('#elements button[aria-pressed=true]').count(), 1);
        assert.ok((await page.locator('#element .law').count()) >= 1);
        for (const element of [elements[elements.length - 1], elements[0]]) {
          await page.evaluate((one) => window.springpot.select(one), element);
          assert.equal(await page.evaluate(() => window.springpot.selected()), element);
          const at = await page.evaluate(() => { const s = window.springpot, one = s.data.cases[s.shown()[0]], t = one.time[Math.round(0.43 * (one.rows - 1))]; s.seek(t); return t; });
          await drawn(page);
          await page.waitForTimeout(150);
          const values = await page.evaluate(([one, t]) => {
            const s = window.springpot, of = s.data.cases[s.shown()[0]], row = of.rowAt(t), { columns } = s.data;
            const most = (unit) => Math.max(...columns.map((column, i) => (column.name.startsWith(`${one}.`) && column.unit === unit ? of.data[i].reduce((m, v) => (Math.abs(v) > m ? Math.abs(v) : m), 0) : 0)));
            return [...document.querySelectorAll('#element .law:first-child .live tr')].map((tr) => {
              const i = s.data.column(`${one}.${tr.cells[0].textContent}`);
              return [tr.cells[0].textContent, tr.cells[1].textContent, of.data[i]?.[row], i >= 0 ? most(columns[i].unit) : 0];
            });
          }, [element, at]);
          // What is rounding beside the largest value of its unit is told as 0.
          for (const [what, text, value, most] of values) if (Number.isFinite(value)) assert.ok(near(text, Math.abs(value) <= 1e-13 * most ? 0 : value), `${element.slice(0, 40)}.${what} is said to be ${text}, not ${value}`);
          if (values.length) assert.ok(values.some(([what]) => what === 'force'), 'no force is told');
        }
        await page.evaluate(() => window.springpot.seek(0));
      }
    });

    check('everything has a name for those who do not see it', async (page, context, { context: browsing }) => {
      const found = await named(browsing, page), roles = (role) => found.filter((one) => one.role === role).map((one) => one.name);
      assert.deepEqual(roles('slider'), ['Time']);
      for (const button of ['Play', 'One row back', 'One row on', 'Loop', 'Reset the view', 'Switch between light and dark', 'Help and keyboard shortcuts']) assert.ok(roles('button').includes(button), `no button "${button}"`);
      const bodies = await page.evaluate(() => window.springpot.data.scenes[0]?.bodies.length ?? 0);
      assert.ok(found.some(({ name: text }) => text.startsWith(`Robot in 3D with ${bodies} bodies`)), 'the 3D view does not say what it shows');
      await page.locator('#help-open').click();
      await named(browsing, page);
      await page.keyboard.press('Escape');
      await page.locator('.add').click();
      await named(browsing, page);
      await page.keyboard.press('Escape');
      // All of it is reached by the keyboard, in the order of the page, and seen where it is.
      await page.locator('h1').click();
      let last = '', seen = new Set();
      for (let i = 0; i < 12; i++) {
        await page.keyboard.press('Tab');
        last = await page.evaluate(() => { const node = document.activeElement; return `${node.tagName}#${node.id}${node.value ?? ''} ${getComputedStyle(node).outlineStyle !== 'none' || getComputedStyle(node).boxShadow !== 'none'}`; });
        assert.match(last, /true$/, `the focus on ${last} is not seen`);
        seen.add(last);
      }
      assert.ok(seen.size >= 8, [...seen].join(', '));
    });

    check('texts stand out in light and dark', async (page) => {
      assert.deepEqual(await faint(page), []);
      await page.locator('#theme').click();
      assert.deepEqual(await faint(page), []);
      const [light, dark] = await page.evaluate(() => [getComputedStyle(document.body).color, getComputedStyle(document.body).backgroundColor].map((text) => text.match(/[\d.]+/g).slice(0, 3).map(Number).reduce((a, b) => a + b, 0)));
      assert.ok(dark < 150 && light > 500, `dark is ${dark} behind ${light}`);
      await page.locator('#theme').click();
    });

    test('a phone shows all of it', async () => {
      const { page, seen, context, close } = await open(name, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 0.5 });
      await page.waitForTimeout(200);
      const wide = () => page.evaluate(() => [...document.querySelectorAll('html, body, main')].map((node) => node.scrollWidth - innerWidth).filter((by) => by > 0));
      assert.deepEqual(await wide(), []);
      // Nothing reaches over the right edge but what is cut there.
      assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll('button, input, select, canvas, table, h1, h2, h3, p')].filter((node) => node.checkVisibility() && !node.closest('.hidden') && node.getBoundingClientRect().right > innerWidth + 0.5).map((node) => `${node.tagName}#${node.id}.${node.className}`)), []);
      const small = await page.evaluate(() => [...document.querySelectorAll('#transport button:not(.mark), #transport select, .tools button, .pick, .chip')].filter((node) => node.checkVisibility()).map((node) => ({ node, box: node.getBoundingClientRect() })).filter(({ box }) => box.width < 24 || box.height < 24).map(({ node }) => node.id || node.className));
      assert.deepEqual(small, [], 'too small for a finger');
      const [buttons, loop, clock] = await page.evaluate(() => ['#play', '#loop', '#clock'].map((id) => { const node = document.querySelector(id), box = node.getBoundingClientRect(); return { y: box.y + box.height / 2, cut: node.scrollWidth > node.clientWidth }; }));
      assert.ok(Math.abs(buttons.y - loop.y) < 6 && !clock.cut, 'the row of buttons does not fit');
      await page.evaluate(() => document.querySelector('main').scrollTo(0, 1e6));
      await page.waitForTimeout(100);
      const play = await page.locator('#play').boundingBox();
      assert.ok(play.y >= 0 && play.y + play.height <= 844, 'play is out of reach');
      await page.locator('#play').tap();
      assert.equal(await page.evaluate(() => window.springpot.playing() || window.springpot.data.cases[0].rows < 2), true);
      await page.locator('#play').tap();
      await page.locator('#help-open').tap();
      assert.deepEqual(await wide(), []);
      await named(context, page);
      assert.deepEqual(seen.errors, []);
      await close();
    });
  });
});

describe('all pages', () => {
  test('hostile names are text', { skip: !has('hostile') }, async () => {
    const { page, seen, close } = await open('hostile');
    const { title, cases, notes } = await page.evaluate(() => { const { data } = window.springpot; return { title: data.title, cases: data.cases.map((one) => one.name), notes: data.notes }; });
    assert.ok(/<script>/.test(title) && /onerror/.test(title), 'the title is harmless');
    await page.locator('#mode [value=stored]').click();
    await page.locator('#layout [value=beside]').click();
    await page.locator('#layout [value=overlay]').click();
    for (const chip of await page.locator('#elements button').all()) await chip.click();
    await page.locator('.plot').first().locator('canvas.over').hover();
    await page.locator('.plot header button').first().click();
    await page.locator('#picker-search').fill('');
    await page.locator('#picker-list input').last().check();
    await page.locator('#picker .strong').click();
    await page.locator('#view canvas').hover();
    await page.waitForTimeout(300);
    const text = await page.locator('body').innerText();
    for (const part of [title.slice(0, 60), cases[0]?.slice(0, 40), notes[0]?.slice(0, 40)].filter(Boolean)) assert.ok(text.includes(part), `${part} is not shown as it is`);
    const found = await page.evaluate(() => ({
      scripts: document.scripts.length, others: [...document.querySelectorAll('img, iframe, object, embed, base, form[action], link:not([rel=icon]), meta[http-equiv=refresh], svg script')].map((node) => node.outerHTML.slice(0, 80)),
      handlers: [...document.querySelectorAll('*')].filter((node) => node.getAttributeNames().some((key) => key.startsWith('on'))).length,
      long: Math.max(...[...document.querySelectorAll('[title], [aria-label]')].map((node) => Math.max(node.getAttribute('title')?.length ?? 0, node.getAttribute('aria-label')?.length ?? 0))),
      // What has no width or turns the direction of text could make a name look like another.
      unseen: /[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2066-\u2069]/.test(document.body.innerText + document.title + [...document.querySelectorAll('[title], [aria-label]')].map((node) => node.title + node.ariaLabel).join('')),
    }));
    assert.deepEqual(found.others, []);
    assert.equal(found.scripts, 2);
    assert.equal(found.handlers, 0);
    assert.equal(found.unseen, false);
    assert.ok(found.long <= 1500, `a title or label of ${found.long} characters`);
    assert.equal(seen.dialogs, 0);
    assert.deepEqual(seen.errors, []);
    assert.equal(await page.locator('html').evaluate((node) => node.scrollWidth > node.clientWidth), false);
    const bar = await page.locator('#bar').boundingBox();
    assert.ok(bar.height < 70, 'the title breaks the layout');
    await close();
  });

  test('a frame of the humanoid takes at most 8 ms of script', { skip: !has('humanoid') }, async (context) => {
    const { page, close } = await open('humanoid');
    const { moving, columns, rows, triangles } = await page.evaluate(() => { const { data } = window.springpot; return { moving: data.scenes[0].bodies.filter((body) => body.joint.kind !== 'fixed').length, columns: data.columns.length, rows: data.cases[0].rows, triangles: data.meshes.flat().reduce((sum, part) => sum + (part.triangles.length * 3) / 4 / 12, 0) }; });
    await page.evaluate(() => { window.springpot.play(); });
    await page.waitForTimeout(1500);
    await page.evaluate(() => window.springpot.clearFrame());
    await page.waitForFunction(() => window.springpot.frame().count > 60, null, { timeout: 90000 });
    const { scriptMs, fps, count } = await page.evaluate(() => window.springpot.frame());
    context.diagnostic(`${moving} joints, ${rows} rows of ${columns} columns, ${Math.round(triangles)} triangles of meshes; script per frame: median ${scriptMs.median} ms, 95 % ${scriptMs.p95} ms, most ${scriptMs.max} ms; ${fps} frames per second, ${count} frames`);
    assert.ok(moving >= 28, `${moving} joints`);
    assert.ok(scriptMs.median <= 8, `${scriptMs.median} ms`);
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
    assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll('*')].filter((node) => getComputedStyle(node).transitionDuration.split(', ').some((each) => parseFloat(each) > 0) || getComputedStyle(node).animationName !== 'none').map((node) => node.id || node.className)), []);
    // The view does not turn on after the hand has left it.
    const box = await page.locator('#view canvas').boundingBox(), camera = () => page.evaluate(() => window.springpot.camera());
    const before = await camera();
    await page.mouse.move(box.x + 200, box.y + 150);
    await page.mouse.down();
    await page.mouse.move(box.x + 300, box.y + 170, { steps: 4 });
    await page.mouse.up();
    await page.waitForTimeout(100);
    const left = await camera();
    assert.notDeepEqual(left, before);
    await page.waitForTimeout(400);
    assert.deepEqual(await camera(), left);
    // Who plays it wants to see it.
    await page.keyboard.press(' ');
    assert.equal(await page.evaluate(() => window.springpot.playing()), true);
    await close();
  });
});
