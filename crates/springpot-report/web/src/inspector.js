/** @file Elements: their list, law, parameters and live values; the run's energies and metrics. */

import { byId, h, setText, title } from './dom.js';
import { parts } from './elements.js';
import { formula, number, unitText } from './format.js';

/** Numbers that change faster cannot be read. */
const EVERY = 70;
/** Of the largest value of a unit, what is its rounding. */
const ROUNDING = 1e-13;

export class Inspector {
  /** @param {any} app */
  constructor(app) {
    this.app = app;
    this.list = byId('elements');
    this.host = byId('element');
    this.last = 0;
    /** @type {{cell: HTMLElement, column: number, least: number}[]} */
    this.values = [];
    this.bars = [];
    this.energies = [];
    this.buttons = [];
    this.begin();
  }

  /** A new primary case: its scene's elements. */
  begin() {
    const { app } = this, one = app.primary(), scene = one ? app.data.scenes[one.scene] : null;
    this.elements = scene?.elements ?? [];
    // An element without a place in the scene can still be read.
    const placed = new Set(this.elements.flatMap((element) => [element.name, ...parts(element)]));
    const others = app.data.elements.filter((element) => !placed.has(element.name)).map((element) => ({ name: element.name, shape: {} }));
    this.all = [...this.elements, ...others];
    byId('elements-panel').hidden = !this.all.length;
    this.buttons = this.all.map((element) => h('button', { class: 'chip', title: title(element.name), 'aria-pressed': 'false', onclick: () => app.select(element.name) },
      h('span', { class: 'swatch', 'aria-hidden': 'true' }), h('span', { class: 'text', text: element.name })));
    this.list.replaceChildren(...this.buttons);
    this.show();
    this.energy();
    this.metrics();
  }

  show() {
    const { app } = this, element = this.all.find((each) => each.name === app.selected) ?? null;
    this.all.forEach((each, i) => this.buttons[i].setAttribute('aria-pressed', String(each === element)));
    this.values = [];
    this.bars = [];
    if (!element) {
      this.host.replaceChildren();
      return;
    }
    const blocks = parts(element).map((name) => this.block(name, parts(element).length > 1));
    this.host.replaceChildren(...blocks);
    this.refresh(true);
  }

  /** One law: equation, parameters, values, energies. */
  block(name, several) {
    const { data } = this.app, one = this.app.primary(), law = data.elements.find((each) => each.name === name);
    const node = h('div', { class: 'law' });
    if (several) node.append(h('h4', { text: name, title: title(name) }));
    if (law) {
      const equation = h('p', { class: 'equation' });
      formula(equation, law.equation || '');
      node.append(h('p', { class: 'kind', text: law.law }), equation);
      if (law.source) node.append(h('p', { class: 'source', text: law.source }));
      if (law.parameters?.length) {
        node.append(h('table', {}, h('caption', { text: 'Parameters' }), h('tbody', {}, ...law.parameters.map((p) => {
          const key = `element.${name}.${p.name}`, swept = one && key in one.parameters, value = swept ? one.parameters[key] : p.value;
          const head = h('th', { scope: 'row' });
          formula(head, p.name);
          return h('tr', { class: swept ? 'swept' : '' }, head, h('td', { text: typeof value === 'number' ? number(value, 6) : String(value) }), h('td', { class: 'unit', text: unitText(p.unit) + (swept ? ' · swept' : '') }));
        }))));
      }
    }
    const own = data.columns.map((column, i) => ({ ...column, i, short: column.name.slice(name.length + 1) })).filter((column) => column.name.startsWith(`${name}.`));
    // Generalized forces come last, and only on joints that the element acts on.
    // What is rounding beside others of its unit is 0.
    const most = (column) => (one ? Math.max(...this.app.range(one, column.i).map(Math.abs).filter(Number.isFinite), 0) : 0);
    const least = (column) => ROUNDING * Math.max(...own.filter((other) => other.unit === column.unit).map(most));
    const columns = [...own.filter((column) => !column.short.startsWith('Q.')), ...own.filter((column) => column.short.startsWith('Q.') && one && (one.status === 'running' || most(column) > least(column)))];
    if (columns.length) {
      node.append(h('table', { class: 'live' }, h('caption', { text: 'At this moment' }), h('tbody', {}, ...columns.slice(0, 60).map((column) => {
        const cell = h('td');
        this.values.push({ cell, column: column.i, least: least(column) });
        return h('tr', {}, h('th', { scope: 'row', text: column.short.length > 60 ? `${column.short.slice(0, 60)}…` : column.short, title: title(column.meaning || column.name) }), cell, h('td', { class: 'unit', text: unitText(column.unit) }));
      }))));
    }
    const stored = data.column(`${name}.stored`), dissipated = data.column(`${name}.dissipated`);
    if (stored >= 0 || dissipated >= 0) {
      const group = [['stored', stored], ['dissipated', dissipated]].filter(([, c]) => /** @type {number} */ (c) >= 0);
      const rows = group.map(([kind, column]) => {
        const bar = h('div', { class: `fill ${kind}` }), value = h('span', { class: 'value' });
        this.bars.push({ bar, value, column, group: group.map(([, c]) => c) });
        return h('div', { class: 'energy' }, h('span', { text: String(kind) }), h('div', { class: 'track', role: 'presentation' }, bar), value);
      });
      node.append(h('div', { class: 'bars' }, h('p', { class: 'caption', text: 'Energy' }), ...rows));
    }
    return node;
  }

  energy() {
    const { data } = this.app;
    const rows = data.columns.map((column, i) => ({ ...column, i })).filter((column) => column.name.startsWith('energy.'));
    byId('energy-panel').hidden = !rows.length;
    this.energies = rows.map((column) => ({ cell: h('td'), column: column.i, name: column.name.slice(7), unit: column.unit, meaning: column.meaning }));
    const sums = ['stored', 'dissipated'].map((kind) => ({ cell: h('td'), kind, columns: data.elements.map((element) => data.column(`${element.name}.${kind}`)).filter((c) => c >= 0) })).filter((sum) => sum.columns.length);
    this.sums = sums;
    byId('energy').replaceChildren(...this.energies.map((row) => h('tr', { class: row.name === 'residual' ? 'residual' : '' }, h('th', { scope: 'row', text: row.name, title: title(row.meaning || '') }), row.cell, h('td', { class: 'unit', text: unitText(row.unit) }))),
      ...(rows.length ? sums.map((sum) => h('tr', {}, h('th', { scope: 'row', text: `${sum.kind} in elements` }), sum.cell, h('td', { class: 'unit', text: 'J' }))) : []));
  }

  metrics() {
    const one = this.app.primary(), list = one?.metrics ?? [];
    byId('metrics-panel').hidden = !list.length;
    byId('metrics').replaceChildren(...list.map((m) => h('tr', {}, h('th', { scope: 'row', title: title(`${m.name} of ${m.column}`) }, h('span', { text: m.name }), m.column ? h('span', { class: 'of', text: m.column }) : null),
      h('td', { text: number(m.value) }), h('td', { class: 'unit', text: unitText(m.unit) }))));
  }

  /** Live values, a few times a second. @param {boolean} [now] */
  refresh(now = false) {
    const time = performance.now();
    if (!now && time - this.last < EVERY) return false;
    this.last = time;
    const { app } = this, one = app.primary();
    if (!one) return true;
    const row = one.rowAt(app.player.time), s = one.between(row, app.player.time);
    for (const { cell, column, least } of this.values) {
      const v = one.value(column, row, s);
      setText(cell, number(Math.abs(v) <= least ? 0 : v));
    }
    for (const { bar, value, column, group } of this.bars) {
      const most = Math.max(...group.map((c) => Math.max(...app.range(one, c).map(Math.abs)))) || 1, v = one.value(column, row, s);
      bar.style.transform = `scaleX(${Math.min(Math.abs(v) / most, 1) || 0})`;
      setText(value, `${number(v, 3)} J`);
    }
    for (const { cell, column } of this.energies) setText(cell, number(one.value(column, row, s)));
    for (const { cell, columns } of this.sums ?? []) setText(cell, number(columns.reduce((sum, c) => sum + one.value(c, row, s), 0)));
    const view = app.views.get(one);
    if (view) view.elements.forEach((element, i) => { /** @type {any} */ (this.buttons[i])?.firstChild.style.setProperty('background', app.colors.map.hex[element.entry]); });
    return true;
  }
}
