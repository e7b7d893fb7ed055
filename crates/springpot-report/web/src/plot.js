/** @file One plot: curves on one canvas, and the moment that is shown on another above it. */

import { columnColor, DASHES } from './colors.js';
import { free, ordered, widen } from './curve.js';
import { h, plain, title } from './dom.js';
import { label, number, powerText, ticks, unitText } from './format.js';

const LEFT = 54, RIGHT = 14, TOP = 20, BOTTOM = 36;

/** @typedef {{x: number, ys: number[]}} Choice columns of a plot */

export class Plot {
  /** @param {any} app @param {Choice} choice @param {{edit: (plot: Plot) => void, remove: (plot: Plot) => void}} on */
  constructor(app, choice, on) {
    this.app = app;
    this.choice = choice;
    /** What a reader zoomed to; null: all. @type {{x0: number, x1: number, y0: number, y1: number}|null} */
    this.zoom = null;
    this.frame = { x0: 0, x1: 1, y0: 0, y1: 1, left: LEFT, top: TOP, width: 1, height: 1 };
    this.dirty = true;
    this.shownTime = NaN;
    this.hover = null;
    this.pointers = new Map();
    this.heading = h('h3', {});
    this.base = h('canvas', { role: 'img' });
    this.over = h('canvas', { class: 'over', 'aria-hidden': 'true' });
    this.tip = h('div', { class: 'tip', hidden: true });
    this.area = h('div', { class: 'area' }, this.base, this.over, this.tip);
    this.node = h('article', { class: 'plot' },
      h('header', {}, this.heading,
        h('button', { class: 'icon', title: 'Choose columns', 'aria-label': 'Choose columns of this plot', onclick: () => on.edit(this) }, icon('M4 6h10M18 6h2M4 12h2M10 12h10M4 18h8M16 18h4', [[16, 6], [8, 12], [14, 18]])),
        h('button', { class: 'icon', title: 'Remove plot', 'aria-label': 'Remove this plot', onclick: () => on.remove(this) }, icon('M6 6l12 12M18 6L6 18'))),
      this.area);
    this.listen();
    this.observer = new ResizeObserver(() => { this.dirty = true; app.wake(); });
    this.observer.observe(this.area);
  }

  close() {
    this.observer.disconnect();
    this.node.remove();
  }

  get timed() {
    return this.choice.x === this.app.data.column('t') || this.choice.x < 0;
  }

  /** @param {import('./data.js').Case} one */
  xs(one) {
    return this.choice.x < 0 ? one.time : one.data[this.choice.x];
  }

  /** Colour and dash of a curve. */
  stroke(slot, k, cases) {
    const many = cases > 1;
    return { color: many ? this.app.caseColors[slot] : columnColor(k, this.app.dark), dash: many ? DASHES[k % DASHES.length] : DASHES[0] };
  }

  /** All that is there, unless a reader zoomed. */
  fit() {
    const { app, choice, frame } = this;
    if (this.zoom) return Object.assign(frame, this.zoom);
    let x0 = Infinity, x1 = -Infinity, y0 = Infinity, y1 = -Infinity;
    for (const one of app.shownCases()) {
      const [a, b] = choice.x < 0 ? [one.start, one.end] : app.range(one, choice.x);
      x0 = Math.min(x0, a);
      x1 = Math.max(x1, b);
      for (const y of choice.ys) {
        const [c, d] = app.range(one, y);
        y0 = Math.min(y0, c);
        y1 = Math.max(y1, d);
      }
    }
    [frame.x0, frame.x1] = widen(x0, x1, this.timed ? 0 : 0.04);
    [frame.y0, frame.y1] = widen(y0, y1, 0.07);
    return frame;
  }

  /** @param {HTMLCanvasElement} canvas @param {number} w @param {number} h */
  size(canvas, w, h) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
    const g = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    return g;
  }

  /** Axes and curves; only when something else than the time changed. */
  draw() {
    const { app, choice } = this, w = this.area.clientWidth, height = this.area.clientHeight;
    if (!w || !height) return;
    this.dirty = false;
    this.shownTime = NaN;
    this.width = w;
    this.tall = height;
    const g = this.size(this.base, w, height);
    this.pen = this.size(this.over, w, height);
    const f = this.fit();
    Object.assign(f, { left: LEFT, top: TOP, width: Math.max(w - LEFT - RIGHT, 10), height: Math.max(height - TOP - BOTTOM, 10) });
    const { palette } = app, columns = app.data.columns;
    g.clearRect(0, 0, w, height);
    g.font = '11px ' + palette.font;
    g.lineWidth = 1;
    const tx = ticks(f.x0, f.x1, f.width / 80), ty = ticks(f.y0, f.y1, f.height / 38);
    g.strokeStyle = palette.rule;
    g.fillStyle = palette.soft;
    g.textAlign = 'center';
    g.textBaseline = 'top';
    for (const v of tx.values) {
      const x = Math.round(f.left + ((v - f.x0) / (f.x1 - f.x0)) * f.width) + 0.5;
      line(g, x, f.top, x, f.top + f.height);
      g.fillText(tx.text(v), x, f.top + f.height + 5);
    }
    g.textAlign = 'right';
    g.textBaseline = 'middle';
    for (const v of ty.values) {
      const y = Math.round(f.top + ((f.y1 - v) / (f.y1 - f.y0)) * f.height) + 0.5;
      g.strokeStyle = Math.abs(v) < 1e-12 * (f.y1 - f.y0) ? palette.zero : palette.rule;
      line(g, f.left, y, f.left + f.width, y);
      g.fillText(ty.text(v), f.left - 7, y);
    }
    const xc = choice.x < 0 ? { name: 'row', unit: '' } : columns[choice.x];
    g.fillStyle = palette.ink;
    g.textAlign = 'right';
    g.textBaseline = 'bottom';
    const power = powerText(tx.power);
    g.fillText(clip(g, label(xc) + (power ? `  ${power}` : ''), f.width), f.left + f.width, height - 3);
    g.textAlign = 'left';
    g.textBaseline = 'top';
    const units = [...new Set(choice.ys.map((y) => unitText(columns[y].unit)))].filter(Boolean).join(', ');
    g.fillText(clip(g, `${units || (choice.ys.length ? '1' : '')}${ty.power ? `  ${powerText(ty.power)}` : ''}`, f.width), 8, 2);
    g.save();
    g.beginPath();
    g.rect(f.left, f.top, f.width, f.height);
    g.clip();
    if (this.timed) {
      g.strokeStyle = palette.event;
      g.setLineDash([2, 3]);
      g.fillStyle = palette.soft;
      g.font = '10px ' + palette.font;
      let free = -Infinity;
      for (const { name, t } of app.primary()?.events ?? []) {
        const x = Math.round(f.left + ((t - f.x0) / (f.x1 - f.x0)) * f.width) + 0.5;
        line(g, x, f.top, x, f.top + f.height);
        const text = clip(g, name, 90);
        if (x < free || x > f.left + f.width - 20) continue;
        g.fillText(text, x + 3, f.top + 2);
        free = x + g.measureText(text).width + 10;
      }
      g.setLineDash([]);
    }
    g.lineJoin = 'round';
    const shown = app.shown, cases = app.shownCases();
    // The first case lies on top.
    for (let c = cases.length - 1; c >= 0; c--) {
      const one = cases[c], xs = this.xs(one);
      if (!one.rows) continue;
      choice.ys.forEach((y, k) => {
        const { color, dash } = this.stroke(shown[c], k, cases.length);
        g.strokeStyle = color;
        g.lineWidth = one === app.primary() ? 2 : 1.4;
        g.setLineDash(dash);
        if (this.timed) {
          const from = Math.max(one.rowAt(f.x0) - 1, 0), to = Math.min(one.rowAt(f.x1) + 2, one.rows);
          ordered(g, xs, one.data[y], from, to, f);
        } else free(g, xs, one.data[y], 0, one.rows, f);
      });
    }
    g.restore();
    this.head();
  }

  /** Names above the plot and for those who do not see it. */
  head() {
    const { app, choice } = this, { columns } = app.data, many = app.shown.length > 1;
    const names = choice.ys.map((y, k) => {
      const mark = h('span', { class: many ? 'dash' : 'swatch', 'aria-hidden': 'true' });
      if (!many) mark.style.background = columnColor(k, app.dark);
      else mark.dataset.dash = String(k % DASHES.length);
      return h('span', { class: 'name', title: title(columns[y].meaning || columns[y].name) }, choice.ys.length > 1 || !many ? mark : null, h('span', { text: columns[y].name }));
    });
    const x = choice.x < 0 ? 'row' : columns[choice.x].name;
    if (!this.timed) names.push(h('span', { class: 'over-x', title: title(x), text: `over ${x}` }));
    this.heading.replaceChildren(...names);
    const spans = choice.ys.slice(0, 6).map((y) => {
      const ranges = app.shownCases().map((one) => app.range(one, y));
      const low = Math.min(...ranges.map((r) => r[0])), high = Math.max(...ranges.map((r) => r[1]));
      return `${title(columns[y].name)} from ${number(low)} to ${number(high)} ${unitText(columns[y].unit)}`;
    });
    this.base.setAttribute('aria-label', `Plot over ${title(x)}: ${spans.join('; ')}; ${app.shown.length} ${app.shown.length === 1 ? 'case' : 'cases'}`);
  }

  /** The moment: a line where x is time, and a point on every curve. Nothing is allocated here. */
  cursor(time) {
    const g = this.pen;
    if (this.dirty || !g || (time === this.shownTime && !this.hoverMoved)) return;
    this.shownTime = time;
    this.hoverMoved = false;
    const { app, frame: f, choice } = this, { palette } = app;
    g.clearRect(0, 0, this.width, this.tall);
    if (this.hover && this.timed) {
      g.strokeStyle = palette.zero;
      g.lineWidth = 1;
      line(g, Math.round(this.hover.x) + 0.5, f.top, Math.round(this.hover.x) + 0.5, f.top + f.height);
    }
    if (this.timed) {
      const x = f.left + ((time - f.x0) / (f.x1 - f.x0)) * f.width;
      if (x >= f.left - 0.5 && x <= f.left + f.width + 0.5) {
        g.strokeStyle = palette.accent;
        g.lineWidth = 1.5;
        line(g, x, f.top - 2, x, f.top + f.height);
        g.fillStyle = palette.accent;
        g.beginPath();
        g.moveTo(x - 4.5, f.top - 7);
        g.lineTo(x + 4.5, f.top - 7);
        g.lineTo(x, f.top);
        g.fill();
      }
    }
    const shown = app.shown;
    for (let c = shown.length - 1; c >= 0; c--) {
      const one = app.data.cases[shown[c]];
      if (!one.rows) continue;
      const row = one.rowAt(time), s = one.between(row, time);
      const xv = choice.x < 0 ? row + s : one.value(choice.x, row, s);
      const px = f.left + ((xv - f.x0) / (f.x1 - f.x0)) * f.width;
      for (let k = 0; k < choice.ys.length; k++) {
        const py = f.top + ((f.y1 - one.value(choice.ys[k], row, s)) / (f.y1 - f.y0)) * f.height;
        if (!(px >= f.left - 1 && px <= f.left + f.width + 1 && py >= f.top - 1 && py <= f.top + f.height + 1)) continue;
        g.fillStyle = shown.length > 1 ? app.caseColors[shown[c]] : columnColor(k, app.dark);
        g.strokeStyle = palette.panel;
        g.lineWidth = 2;
        g.beginPath();
        g.arc(px, py, one === app.primary() ? 5 : 3.6, 0, 7);
        g.fill();
        g.stroke();
      }
    }
  }

  /** Values under the pointer. @param {number} x @param {number} y */
  point(x, y) {
    const { app, frame: f, choice } = this, { columns } = app.data;
    this.hover = { x, y };
    this.hoverMoved = true;
    app.wake();
    const rows = [];
    if (this.timed) {
      const t = f.x0 + ((x - f.left) / f.width) * (f.x1 - f.x0);
      rows.push(h('div', { class: 'at', text: `${choice.x < 0 ? 'row' : 't'} = ${number(t)} ${choice.x < 0 ? '' : unitText(columns[choice.x].unit)}` }));
      app.shownCases().forEach((one, c) => {
        if (!one.rows || t > one.end || t < one.start) return;
        const row = one.rowAt(t), s = one.between(row, t);
        choice.ys.forEach((col, k) => rows.push(this.line(one, c, k, one.value(col, row, s))));
      });
    } else {
      const found = this.nearest(x, y);
      if (!found) {
        this.tip.hidden = true;
        return;
      }
      const { one, c, row } = found;
      rows.push(h('div', { class: 'at', text: `t = ${number(one.time[row])} s` }));
      rows.push(h('div', {}, h('span', { class: 'of', text: columns[choice.x].name }), h('b', { text: `${number(one.data[choice.x][row])} ${unitText(columns[choice.x].unit)}` })));
      choice.ys.forEach((col, k) => rows.push(this.line(one, c, k, one.data[col][row])));
    }
    const more = rows.length - 14;
    if (more > 0) rows.splice(14, more, h('div', { class: 'at', text: `and ${more} more` }));
    this.tip.replaceChildren(...rows);
    this.tip.hidden = false;
    const w = this.tip.offsetWidth, tall = this.tip.offsetHeight;
    this.tip.style.left = `${Math.max(2, x + 14 + w > this.width ? x - w - 12 : x + 14)}px`;
    this.tip.style.top = `${Math.min(Math.max(2, y - tall / 2), Math.max(this.tall - tall - 2, 2))}px`;
  }

  line(one, c, k, value) {
    const { app, choice } = this, column = app.data.columns[choice.ys[k]], many = app.shown.length > 1;
    const mark = h('span', { class: 'swatch' });
    mark.style.background = this.stroke(app.shown[c], k, app.shown.length).color;
    const name = many ? app.data.caseName(one) + (choice.ys.length > 1 ? ` · ${column.name}` : '') : column.name;
    return h('div', {}, mark, h('span', { class: 'of', text: name }), h('b', { text: Number.isFinite(value) ? `${number(value)} ${unitText(column.unit)}` : 'no value' }));
  }

  /** The row of any curve nearest to a place. */
  nearest(x, y) {
    const { app, frame: f, choice } = this;
    let best = null, least = 40 * 40;
    app.shownCases().forEach((one, c) => {
      const xs = this.xs(one), skip = Math.max(1, Math.floor(one.rows / 20000));
      for (const col of choice.ys) {
        const ys = one.data[col];
        for (let row = 0; row < one.rows; row += skip) {
          const dx = f.left + ((xs[row] - f.x0) / (f.x1 - f.x0)) * f.width - x, dy = f.top + ((f.y1 - ys[row]) / (f.y1 - f.y0)) * f.height - y;
          const d = dx * dx + dy * dy;
          if (d < least) { least = d; best = { one, c, row }; }
        }
      }
    });
    return best;
  }

  /** Where a pointer seeks to. */
  seek(x, y) {
    const f = this.frame;
    if (this.timed) this.app.seek(f.x0 + (Math.min(Math.max((x - f.left) / f.width, 0), 1)) * (f.x1 - f.x0));
    else {
      const found = this.nearest(x, y);
      if (found) this.app.seek(found.one.time[found.row]);
    }
  }

  /** Zooms about a place. @param {number} x @param {number} y @param {number} by factor of the range @param {boolean} inX @param {boolean} inY */
  scale(x, y, by, inX, inY) {
    const f = this.frame, z = { x0: f.x0, x1: f.x1, y0: f.y0, y1: f.y1 };
    if (inX) {
      const at = f.x0 + ((x - f.left) / f.width) * (f.x1 - f.x0);
      z.x0 = at + (f.x0 - at) * by;
      z.x1 = at + (f.x1 - at) * by;
    }
    if (inY) {
      const at = f.y1 - ((y - f.top) / f.height) * (f.y1 - f.y0);
      z.y0 = at + (f.y0 - at) * by;
      z.y1 = at + (f.y1 - at) * by;
    }
    // Beyond the digits of the data there is nothing to see.
    const fine = (a, b) => b - a > 2e-6 * Math.max(Math.abs(a), Math.abs(b), 1e-30);
    if (!fine(z.x0, z.x1) || !fine(z.y0, z.y1)) return;
    this.setZoom(z);
  }

  setZoom(zoom) {
    this.zoom = zoom;
    this.dirty = true;
    this.app.wake();
  }

  pan(dx, dy) {
    const f = this.frame, sx = ((f.x1 - f.x0) * dx) / f.width, sy = ((f.y1 - f.y0) * dy) / f.height;
    this.setZoom({ x0: f.x0 - sx, x1: f.x1 - sx, y0: f.y0 + sy, y1: f.y1 + sy });
  }

  listen() {
    const { over, pointers } = this;
    const place = (event) => {
      const box = over.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    over.addEventListener('contextmenu', (event) => event.preventDefault());
    over.addEventListener('dblclick', () => this.setZoom(null));
    over.addEventListener('wheel', (event) => {
      event.preventDefault();
      const [x, y] = place(event), by = Math.exp(Math.min(Math.max(event.deltaY * (event.deltaMode ? 30 : 1), -200), 200) * 0.0022);
      const left = x < this.frame.left, below = y > this.frame.top + this.frame.height;
      this.scale(x, y, by, !left, left || (!below && (!this.timed || event.altKey)));
    }, { passive: false });
    over.addEventListener('pointerdown', (event) => {
      const [x, y] = place(event);
      over.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x, y });
      this.drag = event.button !== 0 || event.shiftKey ? 'pan' : 'seek';
      if (pointers.size === 1 && this.drag === 'seek') this.seek(x, y);
    });
    over.addEventListener('pointermove', (event) => {
      const [x, y] = place(event), old = pointers.get(event.pointerId);
      if (!old) return this.point(x, y);
      const dx = x - old.x, dy = y - old.y;
      if (pointers.size === 2) {
        // Two fingers: the distance zooms, the middle pans.
        const [a, b] = [...pointers.values()], other = a === old ? b : a;
        const before = Math.hypot(old.x - other.x, old.y - other.y), after = Math.hypot(x - other.x, y - other.y);
        if (before > 10 && after > 10) this.scale((x + other.x) / 2, (y + other.y) / 2, before / after, true, !this.timed);
        this.fit();
        this.pan(dx / 2, this.timed ? 0 : dy / 2);
      } else if (this.drag === 'pan') this.pan(dx, dy);
      else {
        this.seek(x, y);
        this.point(x, y);
      }
      old.x = x;
      old.y = y;
      return undefined;
    });
    const end = (event) => {
      pointers.delete(event.pointerId);
      if (event.pointerType === 'touch') this.leave();
    };
    over.addEventListener('pointerup', end);
    over.addEventListener('pointercancel', end);
    over.addEventListener('pointerleave', () => this.leave());
  }

  leave() {
    if (this.pointers.size) return;
    this.hover = null;
    this.hoverMoved = true;
    this.tip.hidden = true;
    this.app.wake();
  }
}

function line(g, x0, y0, x1, y1) {
  g.beginPath();
  g.moveTo(x0, y0);
  g.lineTo(x1, y1);
  g.stroke();
}

/** Cuts a text to a width. */
function clip(g, text, width) {
  text = plain(text.slice(0, 200));
  if (g.measureText(text).width <= width) return text;
  let n = text.length;
  while (n > 1 && g.measureText(`${text.slice(0, n)}…`).width > width) n = Math.floor(n * 0.85);
  return `${text.slice(0, n)}…`;
}

const SVG = 'http://www.w3.org/2000/svg';

/** A drawn sign for a button. @param {string} path @param {number[][]} [dots] */
export function icon(path, dots = []) {
  const svg = document.createElementNS(SVG, 'svg');
  svg.setAttribute('viewBox', '0 0 24 24');
  svg.setAttribute('aria-hidden', 'true');
  const stroke = document.createElementNS(SVG, 'path');
  stroke.setAttribute('d', path);
  svg.append(stroke);
  for (const [x, y] of dots) {
    const dot = document.createElementNS(SVG, 'circle');
    dot.setAttribute('cx', String(x));
    dot.setAttribute('cy', String(y));
    dot.setAttribute('r', '2');
    svg.append(dot);
  }
  return svg;
}

