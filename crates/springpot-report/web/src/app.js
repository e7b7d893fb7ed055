/** @file The page: what is shown, and the one loop that draws it. */

import { caseColor } from './colors.js';
import { CaseList, MOST_SHOWN } from './cases.js';
import { byId, h, plain, setText, title } from './dom.js';
import { ElementShapes } from './elements.js';
import { extent } from './extent.js';
import { follow } from './follow.js';
import { number } from './format.js';
import { Inspector } from './inspector.js';
import { Kinematics } from './kinematics.js';
import { listen } from './keys.js';
import { Overlay } from './overlay.js';
import { Player } from './player.js';
import { Plots } from './plots.js';
import { Colors } from './range.js';
import { RobotShape, decodeMeshes } from './robot.js';
import { Stage } from './stage.js';
import { Stats } from './stats.js';
import { palette, remember, remembered } from './theme.js';
import { Transport } from './transport.js';
import { CaseView } from './view.js';

/** Up to so many cases are shown at once at first. */
const GHOSTS = 6;

export class App {
  /** @param {import('./data.js').Data} data */
  constructor(data) {
    this.data = data;
    this.column = (name) => data.column(name);
    const quiet = matchMedia('(prefers-reduced-motion: reduce)').matches, night = matchMedia('(prefers-color-scheme: dark)');
    const before = remembered();
    this.dark = before ? before === 'dark' : night.matches;
    if (!before) night.addEventListener('change', (event) => this.setDark(event.matches, false));
    document.documentElement.dataset.theme = this.dark ? 'dark' : 'light';
    this.palette = palette();
    /** Shown cases by their place in the list; the first is solid. @type {number[]} */
    this.shown = data.cases.length <= GHOSTS ? data.cases.map((_, i) => i) : [0];
    if (!data.cases.length) this.shown = [];
    this.beside = false;
    this.live = Boolean(data.follow);
    /** @type {string|null} */
    this.selected = null;
    /** @type {Map<string, {version: number, value: number[]}>} */
    this.ranges = new Map();
    this.caseColors = [];
    this.paint();
    this.colors = new Colors(data);
    this.stats = new Stats();
    this.player = new Player(() => this.shownCases());
    this.player.fit();
    this.player.choose();
    this.wanted = 0;
    this.gap = 16;
    this.thrift = 0;
    this.tick = this.tick.bind(this);
    this.stage = new Stage(byId('view'), quiet, () => this.wake());
    byId('nogl').hidden = Boolean(this.stage.renderer);
    this.meshes = decodeMeshes(data.meshes);
    /** @type {Map<number, import('./view.js').Shared>} */
    this.shared = new Map();
    /** @type {Map<import('./data.js').Case, CaseView>} */
    this.views = new Map();
    this.overlay = new Overlay(this);
    this.frameMotion();
    this.head();
    this.transport = new Transport(this);
    this.transport.setLoop(true);
    this.transport.speeds();
    this.cases = new CaseList(this);
    this.plots = new Plots(this);
    this.inspector = new Inspector(this);
    const scene = this.primary() ? data.scenes[this.primary().scene] : null;
    this.select(scene?.elements?.[0]?.name ?? data.elements[0]?.name ?? null, false);
    this.player.listeners.push(() => this.wake());
    this.wire();
    this.arrange();
    this.transport.fit();
    if (data.follow) {
      this.setLive(true);
      this.source = follow(this, data.follow);
    }
  }

  shownCases() {
    return this.shown.map((i) => this.data.cases[i]);
  }

  primaryIndex() {
    return this.shown[0] ?? 0;
  }

  /** The case that is solid and read from. @returns {import('./data.js').Case|undefined} */
  primary() {
    return this.data.cases[this.primaryIndex()];
  }

  /** Colours of the cases; those of a swept number go from dark to light. */
  paint() {
    const { cases } = this.data, n = cases.length;
    const values = cases.map((one) => Object.values(one.parameters)), key = values.map((v) => v.length === 1 && typeof v[0] === 'number' ? v[0] : NaN);
    const ordered = n > 2 && key.every((v, i) => Number.isFinite(v) && (i < 1 || (v > key[i - 1]) === (key[1] > key[0])));
    if (n <= MOST_SHOWN) this.caseColors = cases.map((_, i) => caseColor(i, n, ordered || n > 8, this.dark));
    else {
      this.caseColors = [];
      const rank = [...this.shown].sort((a, b) => a - b);
      rank.forEach((i, k) => { this.caseColors[i] = caseColor(k, rank.length, rank.length > 8 || ordered, this.dark); });
    }
  }

  /** @param {import('./data.js').Case} one */
  view(one) {
    let view = this.views.get(one);
    if (!view) {
      view = new CaseView(one, this.share(one), this.column);
      this.views.set(one, view);
    }
    return view;
  }

  /** What cases of one scene have in common. */
  share(one) {
    let shared = this.shared.get(one.scene);
    if (!shared) {
      const scene = this.data.scenes[one.scene] ?? { bodies: [], elements: [], root: null, ground: null, gripper: null, wanted: null };
      scene.bodies ??= [];
      const tree = new Kinematics(scene, this.column);
      tree.place(one, 0, 0);
      const robot = new RobotShape(scene, this.meshes, tree, (body) => this.travel(one.scene, tree.drivers[body]));
      shared = { scene, tree, robot, elements: new ElementShapes(scene, tree, robot.radius, robot.size, robot.bodies.map((geometry) => geometry?.boundingBox), robot.slides) };
      this.shared.set(one.scene, shared);
    }
    return shared;
  }

  /** Whether all shown cases have one motion, as far as rows tell it: only one robot is then to be seen. */
  sameMotion() {
    const [first, ...rest] = this.shownCases(), columns = this.data.columns.map((column, i) => ({ column, i })).filter(({ column }) => column.name.startsWith('q.'));
    return columns.length > 0 && rest.every((one) => one.rows === first.rows && one.scene === first.scene && columns.every(({ i }) => {
      const [low, high] = this.range(first, i), least = 1e-6 * Math.max(high - low, 1e-9), a = first.data[i], b = one.data[i];
      for (let k = 0; k < first.rows; k++) if (Math.abs(a[k] - b[k]) > least) return false;
      return true;
    }));
  }

  /** Low and high of a joint's coordinate in all cases of a scene; 0 where no row tells it. @param {number} scene @param {{column: number, ratio: number, offset: number}|null} driver */
  travel(scene, driver) {
    const own = driver && driver.column >= 0 ? this.data.cases.filter((one) => one.scene === scene && one.rows > 0) : [];
    const ends = own.flatMap((one) => this.range(one, driver.column)).filter(Number.isFinite).map((q) => driver.ratio * q + driver.offset);
    return [Math.min(0, ...ends), Math.max(0, ...ends)];
  }

  /** The camera to the motion of all cases. */
  frameMotion() {
    const { cases } = this.data;
    if (!cases.length) return;
    const box = extent(cases.slice(0, MOST_SHOWN).map((one) => this.view(one)));
    const { ground } = this.data.scenes[cases[0].scene] ?? {};
    this.stage.fit(box.middle, box.radius, ground ? Math.min(ground[2], box.low) : box.low, box.cloud);
    setText(byId('grid-size'), `grid ${number(this.stage.ground.spacing)} m`);
  }

  /** Title, badge and notes. */
  head() {
    const { data } = this;
    document.title = `${plain(data.title.slice(0, 120))} – Springpot`;
    setText(byId('title'), data.title);
    byId('title').title = title(data.title);
    setText(byId('subtitle'), [data.name !== data.title ? data.name : '', data.version && `Springpot ${data.version}`].filter(Boolean).join(' · '));
    this.badge();
    byId('notes-panel').hidden = !data.notes.length;
    byId('notes').replaceChildren(...data.notes.map((note) => h('li', { text: note })));
    byId('live').hidden = !data.follow;
    byId('layout').hidden = data.cases.length < 2;
    byId('mode').hidden = !data.elements.length;
    const failed = data.cases.filter((one) => one.status === 'failed').length;
    if (failed && failed === data.cases.length && data.cases[0].error) this.fail(data.cases[0].error);
  }

  badge() {
    const badge = byId('status');
    badge.className = `badge ${this.data.status}`;
    setText(badge, this.data.status);
  }

  /** An error that a reader must know of. @param {string} text */
  fail(text) {
    byId('error').hidden = false;
    setText(byId('error-text'), String(text).slice(0, 4000));
  }

  /** For those who listen. @param {string} text */
  say(text) {
    setText(byId('say'), text);
  }

  /** Low and high of a column in a case; remembered until rows come in. @param {import('./data.js').Case} one @param {number} column */
  range(one, column) {
    const key = `${one.index}:${column}`, known = this.ranges.get(key);
    if (known && known.version === one.version) return known.value;
    let low = Infinity, high = -Infinity;
    const data = one.data[column];
    for (let i = 0; i < one.rows; i++) {
      const v = data[i];
      if (v < low && v > -Infinity) low = v;
      if (v > high && v < Infinity) high = v;
    }
    const value = [low, high];
    this.ranges.set(key, { version: one.version, value });
    return value;
  }

  /** Shown cases, colours, ranges and viewports anew. */
  arrange() {
    this.paint();
    const views = this.shownCases().map((one) => this.view(one));
    this.colors.set(this.colors.mode, this.shownCases());
    views.forEach((view, i) => view.look(!this.beside && i > 0, this.caseColors[this.shown[i]], this.dark));
    this.stage.setWanted([...new Set(this.shownCases().map((one) => this.data.scenes[one.scene]?.wanted).filter(Boolean))]);
    this.stage.look(this.dark);
    byId('view').classList.toggle('beside', this.beside && views.length > 1);
    this.overlay.colorbar();
    this.room();
    this.stage.show(views, this.beside);
    this.player.fit();
    this.cases.update();
    this.plots.spoil();
    this.overlay.names();
    this.describe();
    for (const button of byId('layout').querySelectorAll('button')) button.setAttribute('aria-pressed', String((button.value === 'beside') === this.beside));
    for (const button of byId('mode').querySelectorAll('button')) button.setAttribute('aria-pressed', String(button.value === this.colors.mode));
    this.wake(true);
  }

  /** What the colour bar takes of the view. */
  room() {
    const { bar } = this.overlay, flat = this.beside || byId('view').clientWidth < 520;
    this.stage.inset = bar.hidden ? 0 : flat ? bar.offsetHeight + 14 : 24;
  }

  describe() {
    const { stage, data } = this;
    const scene = this.primary() ? data.scenes[this.primary().scene] : null;
    stage.canvas?.setAttribute('aria-label', `Robot in 3D with ${scene?.bodies?.length ?? 0} bodies and ${scene?.elements?.length ?? 0} elements; ${this.shown.length} ${this.shown.length === 1 ? 'case' : 'cases'} ${this.beside ? 'side by side' : 'shown'}. Drag to turn, use the slider to move it.`);
  }

  /** @param {number[]} list */
  show(list) {
    const first = this.primaryIndex();
    this.shown = list.slice(0, MOST_SHOWN);
    this.arrange();
    this.transport.fit();
    if (this.primaryIndex() !== first) this.inspector.begin();
  }

  /** @param {number} i */
  toggleCase(i) {
    if (!this.data.cases[i]) return;
    const on = this.shown.includes(i);
    if (on && this.shown.length === 1) {
      this.cases.update(); // the last one stays
      this.say('One case stays shown');
      return;
    }
    if (!on && this.shown.length >= MOST_SHOWN) return;
    const list = on ? this.shown.filter((k) => k !== i) : [...this.shown, i];
    // The solid one stays first, the others follow in the sweep's order.
    this.show([list[0], ...list.slice(1).sort((a, b) => a - b)]);
    this.say(`${this.data.caseName(this.data.cases[i]).slice(0, 100)} ${on ? 'hidden' : 'shown'}`);
  }

  /** @param {number} i */
  makePrimary(i) {
    const rest = this.shown.filter((k) => k !== i).sort((a, b) => a - b);
    this.show([i, ...rest].slice(0, MOST_SHOWN));
    this.inspector.begin();
    this.say(`${this.data.caseName(this.data.cases[i]).slice(0, 100)} is the solid one`);
  }

  /** @param {string|null} name @param {boolean} [open] */
  select(name, open = true) {
    this.selected = name;
    this.inspector.show();
    if (open && name) this.say(`Element ${name.slice(0, 100)}`);
    this.wake();
  }

  /** @param {'force'|'stored'} mode */
  setColorMode(mode) {
    if (mode !== 'force' && mode !== 'stored') return;
    this.colors.mode = mode;
    this.arrange();
    this.say(mode === 'force' ? 'Colours show force' : 'Colours show stored energy');
  }

  /** @param {boolean} on */
  setBeside(on) {
    if (this.data.cases.length < 2) return;
    this.beside = on;
    this.arrange();
    this.resetView();
    this.say(on ? 'Side by side' : 'Overlay');
  }

  /** @param {boolean} dark @param {boolean} [keep] */
  setDark(dark, keep = true) {
    this.dark = dark;
    document.documentElement.dataset.theme = dark ? 'dark' : 'light';
    if (keep) remember(dark);
    this.palette = palette();
    this.arrange();
    this.say(dark ? 'Dark' : 'Light');
  }

  resetView() {
    this.stage.reset();
    this.wake();
  }

  help() {
    byId('help').showModal();
  }

  /** @param {number} t */
  seek(t) {
    if (this.live && t < this.player.end) this.setLive(false);
    this.player.seek(t);
  }

  /** The slider stays at the end of a running simulation. @param {boolean} on */
  setLive(on) {
    this.live = on && Boolean(this.data.follow);
    byId('live').setAttribute('aria-pressed', String(this.live));
    if (this.live) {
      this.player.toggle(false);
      this.player.seek(this.player.end);
    }
  }

  /** Rows came in: once per frame is enough. */
  appended() {
    this.fresh = true;
    this.wake();
  }

  /** @param {import('./data.js').Case[]} added */
  grown(added) {
    this.cases.build();
    byId('layout').hidden = this.data.cases.length < 2;
    if (!this.shown.length || (this.live && this.shown.length < GHOSTS)) this.show([...this.shown, ...added.map((one) => this.data.cases.indexOf(one))].slice(0, GHOSTS));
    else this.arrange();
    this.inspector.begin();
  }

  /** @param {string} status */
  ended(status) {
    this.data.status = status;
    this.badge();
    this.setLive(false);
    byId('live').hidden = true;
    for (const one of this.data.cases) if (one.status === 'running') one.status = status;
    this.cases.build();
    this.say(`The run is ${status}`);
    this.appended();
  }

  /** What new rows change. */
  take() {
    this.fresh = false;
    const empty = this.player.end <= this.player.start, atEnd = this.live;
    this.player.fit();
    if (atEnd) this.player.time = this.player.end;
    const views = this.shownCases().map((one) => this.view(one));
    const now = performance.now();
    // Trails and ranges need all rows: a few times a second.
    if (empty || now - (this.taken ?? 0) > 400 || this.data.status !== 'running') {
      this.taken = now;
      this.colors.set(this.colors.mode, this.shownCases());
      views.forEach((view, i) => view.look(!this.beside && i > 0, this.caseColors[this.shown[i]], this.dark));
      this.overlay.colorbar();
      if (empty) this.frameMotion();
    } else this.fresh = true;
    this.transport.fit();
    this.plots.spoil();
  }

  wire() {
    const { stage } = this;
    byId('theme').addEventListener('click', () => this.setDark(!this.dark));
    byId('help-open').addEventListener('click', () => this.help());
    byId('reset').addEventListener('click', () => this.resetView());
    byId('error-close').addEventListener('click', () => { byId('error').hidden = true; });
    for (const button of byId('mode').querySelectorAll('button')) button.addEventListener('click', () => this.setColorMode(button.value));
    for (const button of byId('layout').querySelectorAll('button')) button.addEventListener('click', () => this.setBeside(button.value === 'beside'));
    for (const dialog of document.querySelectorAll('dialog')) dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });
    for (const button of document.querySelectorAll('dialog .shut')) button.addEventListener('click', () => button.closest('dialog').close(''));
    listen(this);
    const view = byId('view');
    new ResizeObserver(() => {
      const first = !this.sized;
      this.room();
      stage.resize(view.clientWidth, view.clientHeight);
      this.overlay.names();
      // Only now is it known how wide the camera sees.
      if (first) stage.reset();
      this.sized = true;
      this.transport.tidy();
      // Drawn at once, or the emptied canvas would be seen.
      this.force = true;
      this.draw();
    }).observe(view);
    this.split();
    if (!stage.canvas) return;
    const { canvas } = stage;
    let down = null;
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    canvas.addEventListener('pointerdown', (event) => { down = [event.clientX, event.clientY]; this.overlay.hover(null, 0, 0); });
    canvas.addEventListener('pointerup', (event) => {
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 5 || event.button) return;
      const [x, y] = place(event), hit = stage.hit(x, y);
      if (hit?.element) this.select(hit.element.name);
      else if (hit?.mark) this.seek(hit.mark.t);
    });
    canvas.addEventListener('pointermove', (event) => {
      if (event.buttons || event.pointerType === 'touch') return;
      const [x, y] = place(event), hit = stage.hit(x, y);
      canvas.style.cursor = hit ? 'pointer' : 'grab';
      this.overlay.hover(hit, x, y);
    });
    canvas.addEventListener('pointerleave', () => this.overlay.hover(null, 0, 0));
    canvas.addEventListener('dblclick', () => this.resetView());
  }

  /** The border between 3D and plots. */
  split() {
    const handle = byId('split'), left = byId('left');
    const set = (share) => {
      const s = Math.min(Math.max(share, 0.2), 0.85);
      left.style.setProperty('--view', `${(100 * s).toFixed(1)}%`);
      handle.setAttribute('aria-valuenow', String(Math.round(100 * s)));
      this.share3d = s;
    };
    this.share3d = 0.56;
    handle.addEventListener('pointerdown', (event) => {
      handle.setPointerCapture(event.pointerId);
      const move = (e) => {
        const box = left.getBoundingClientRect();
        set((e.clientY - box.top - 50) / box.height);
      };
      handle.addEventListener('pointermove', move);
      handle.addEventListener('lostpointercapture', () => handle.removeEventListener('pointermove', move), { once: true });
    });
    handle.addEventListener('keydown', (event) => {
      const by = { ArrowUp: -0.04, ArrowDown: 0.04 }[event.key];
      if (!by) return;
      event.preventDefault();
      set(this.share3d + by);
    });
  }

  /** Asks for a frame. @param {boolean} [force] draws the robot although the time did not change */
  wake(force = false) {
    if (force) this.force = true;
    if (!this.wanted) this.wanted = requestAnimationFrame(this.tick);
  }

  tick(now) {
    this.wanted = 0;
    const { player } = this;
    const begin = performance.now();
    if (player.playing) player.advance(this.lastTick ? (now - this.lastTick) / 1000 : 0);
    this.spare(player.playing && this.lastTick ? now - this.lastTick : 0);
    this.lastTick = player.playing ? now : 0;
    this.draw();
    this.stats.add(begin, performance.now(), player.playing);
    if (player.playing) this.wake();
  }

  /** Less beauty where frames take long, all of it when nothing moves. @param {number} gap since the last frame, 0 at rest */
  spare(gap) {
    if (!gap) this.stage.save(0);
    else {
      this.gap += 0.1 * (Math.min(gap, 300) - this.gap);
      if (this.gap > 50 && this.thrift < 2) {
        this.thrift++;
        this.gap = 25; // the next level is tried for a while
      }
      this.stage.save(this.thrift);
    }
  }

  /** One frame: bodies, elements, picture, cursors. */
  draw() {
    const { player, stage } = this, t = player.time;
    if (this.fresh) this.take();
    // Damping asks for its next frame through the controls' own event.
    stage.controls?.update();
    if (t !== this.drawn || this.force) {
      for (let i = 0; i < stage.views.length; i++) stage.views[i].update(t, this.colors);
      this.drawn = t;
    }
    this.force = false;
    stage.render();
    this.overlay.frame();
    this.transport.update();
    this.plots.frame(t);
    if (!this.inspector.refresh(!player.playing) && !player.playing) this.wake();
    if (this.fresh) this.wake();
  }
}
