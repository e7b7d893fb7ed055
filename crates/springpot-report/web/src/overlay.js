/** @file What lies over the 3D view: colour bar, names of cases, axes, and what the pointer shows. */

import { byId, h, setText, title } from './dom.js';
import { number, unitText } from './format.js';
import { parts } from './elements.js';

/** Where the cases stand beside the robot, as in the style. */
const WIDE = '(min-width: 761px)';

/** Names without the parts that all of them share: what is cut off is not what tells them apart. @param {string[]} names */
export function shortened(names) {
  const parts = names.map((name) => name.split(', ')), [first] = parts;
  if (names.length < 2 || parts.some((one) => one.length !== first.length)) return names;
  const differs = first.map((part, k) => parts.some((one) => one[k] !== part));
  return differs.some(Boolean) ? parts.map((one) => one.filter((_, k) => differs[k]).join(', ')) : names;
}

export class Overlay {
  /** @param {any} app */
  constructor(app) {
    this.app = app;
    this.bar = byId('colorbar');
    this.labels = byId('labels');
    this.tip = byId('tip');
    this.tag = byId('tag');
    this.lines = ['x', 'y', 'z'].map((axis) => ({ line: byId(`axis-${axis}`), text: byId(`axis-${axis}-name`) }));
    this.at = [0, 0];
    this.camera = new Float64Array(4).fill(NaN);
  }

  /** The map with numbers and units. */
  colorbar() {
    const { colors } = this.app, force = colors.mode === 'force';
    const units = [...colors.units].filter(([, most]) => most > 0);
    this.bar.hidden = !colors.units.size;
    const strip = h('div', { class: 'strip' });
    strip.style.background = colors.map.gradient();
    const scales = (units.length ? units : [...colors.units]).map(([unit, most]) => {
      const ends = force ? [-most, 0, most] : [0, most / 2, most];
      return h('div', { class: 'scale' }, ...ends.map((v) => h('span', { text: number(v, 3) })), h('span', { class: 'unit', text: unitText(unit) || '1' }));
    });
    this.bar.replaceChildren(h('p', { text: force ? 'Force' : 'Stored energy' }), strip, ...scales, force ? h('div', { class: 'sense' }, h('span', { text: 'compression' }), h('span', { text: 'tension' })) : '');
    this.bar.setAttribute('aria-label', `Colours of the elements: ${force ? 'force, blue is compression and orange tension' : 'stored energy, dark is little and yellow much'}${units.map(([unit, most]) => `, up to ${number(most, 3)} ${unitText(unit)}`).join('')}`);
  }

  /** Names of the shown cases: in their viewports, or one below another. */
  names() {
    const { app } = this, { stage, data } = app;
    const short = shortened(app.shown.map((i) => data.caseName(data.cases[i])));
    const chip = (i, at) => {
      const one = data.cases[i], swatch = h('span', { class: 'swatch' });
      swatch.style.background = app.caseColors[i];
      const node = h('div', { class: 'case-name' }, swatch, h('span', { class: 'text', text: short[app.shown.indexOf(i)], title: title(data.caseName(one)) }), one.status === 'done' || one.status === 'running' ? null : h('span', { class: `state ${one.status}`, text: one.status }));
      if (at) {
        node.style.left = `${at.x + 10}px`;
        node.style.top = `${at.y + 10}px`;
        node.style.maxWidth = `${at.w - (at.y === 0 && at.x + at.w > stage.width - 60 ? 62 : 20)}px`; // the button above right stays free
        node.classList.add('placed');
      }
      return node;
    };
    // Where the list of cases stands beside the robot, it says it already.
    const single = data.cases.length < 2, listed = matchMedia(WIDE).matches;
    const nodes = stage.beside ? app.shown.map((i, k) => chip(i, stage.ports[k])) : (single || listed) && !data.cases[0]?.error ? [] : app.shown.slice(0, 6).map((i) => chip(i, null));
    if (!stage.beside && !listed && app.shown.length > 6) nodes.push(h('div', { class: 'case-name', text: `and ${app.shown.length - 6} more` }));
    for (const port of stage.beside ? stage.ports.slice(0, app.shown.length) : []) {
      const frame = h('div', { class: 'port' });
      Object.assign(frame.style, { left: `${port.x}px`, top: `${port.y}px`, width: `${port.w}px`, height: `${port.h}px` });
      nodes.push(frame);
    }
    this.labels.replaceChildren(...nodes);
  }

  /** Follows the camera and the chosen element. */
  frame() {
    const { stage, selected } = this.app, q = stage.camera.quaternion, c = this.camera;
    if (q.x !== c[0] || q.y !== c[1] || q.z !== c[2] || q.w !== c[3]) {
      c[0] = q.x; c[1] = q.y; c[2] = q.z; c[3] = q.w;
      // Columns of the inverse rotation: the world's axes as the camera sees them.
      this.axis(0, 1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.z * q.w));
      this.axis(1, 2 * (q.x * q.y + q.z * q.w), 1 - 2 * (q.x * q.x + q.z * q.z));
      this.axis(2, 2 * (q.x * q.z - q.y * q.w), 2 * (q.y * q.z + q.x * q.w));
    }
    const view = stage.views[0], element = selected && view ? view.elements.find((each) => each.name === selected) : null;
    if (!element || !stage.renderer || !element.meshes.length) {
      if (!this.tag.hidden) this.tag.hidden = true;
      return;
    }
    const { line } = element, n = line.length, m = this.middle ?? (this.middle = new Float64Array(3));
    const turned = element.shape.kind === 'spiral';
    for (let k = 0; k < 3; k++) m[k] = turned ? line[k] : (line[k] + line[n - 3 + k]) / 2;
    const seen = stage.screen(m, 0, stage.ports[0], this.at);
    if (this.tag.hidden === seen) this.tag.hidden = !seen;
    setText(this.tag, element.name);
    const x = Math.min(Math.max(this.at[0], 60), stage.ports[0].w - 60), y = Math.min(Math.max(this.at[1], 40), stage.ports[0].h - 12);
    this.tag.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(18px, -140%)`;
  }

  axis(i, x, y) {
    const { line, text } = this.lines[i];
    line.setAttribute('x2', String(30 + 20 * x));
    line.setAttribute('y2', String(30 - 20 * y));
    text.setAttribute('x', String(30 + 27 * x));
    text.setAttribute('y', String(30 - 27 * y + 3.5));
  }

  /** @param {any} hit @param {number} x @param {number} y */
  hover(hit, x, y) {
    this.tip.hidden = !hit;
    if (!hit) return;
    const { data, shown } = this.app, one = hit.view.one, of = shown.length > 1 ? h('div', { class: 'at', text: data.caseName(one) }) : null;
    const rows = [];
    if (hit.mark) rows.push(h('b', { text: hit.mark.name }), h('div', { text: `event at t = ${number(hit.mark.t)} s` }));
    else {
      rows.push(h('b', { text: hit.element.name }));
      for (const name of parts(hit.element.element)) {
        const law = data.elements.find((each) => each.name === name), force = data.column(`${name}.force`);
        rows.push(h('div', { text: law?.law ?? '' }));
        if (force >= 0) rows.push(h('div', { text: `F = ${number(one.value(force, hit.view.row, hit.view.s))} ${unitText(data.columns[force].unit)}` }));
      }
    }
    this.tip.replaceChildren(...rows, of ?? '');
    const { width, height } = this.app.stage, w = this.tip.offsetWidth, tall = this.tip.offsetHeight;
    this.tip.style.left = `${x + 16 + w > width ? Math.max(x - w - 12, 2) : x + 16}px`;
    this.tip.style.top = `${Math.min(y + 12, Math.max(height - tall - 4, 0))}px`;
  }
}
