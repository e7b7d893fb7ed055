/** @file The plots under the 3D view: which there are at first, and the dialog that chooses columns. */

import { byId, h, title } from './dom.js';
import { label } from './format.js';
import { Plot } from './plot.js';

const MOST_LISTED = 400;

export class Plots {
  /** @param {any} app */
  constructor(app) {
    this.app = app;
    this.host = byId('plots');
    /** @type {Plot[]} */
    this.list = [];
    this.dialog = byId('picker');
    this.search = byId('picker-search');
    this.listing = byId('picker-list');
    this.x = byId('picker-x');
    this.addButton = h('button', { class: 'add', onclick: () => this.edit(null) }, h('span', { 'aria-hidden': 'true', text: '+' }), h('span', { text: 'Add plot' }));
    this.host.append(this.addButton);
    this.search.addEventListener('input', () => this.offer());
    this.dialog.addEventListener('close', () => this.take());
    for (const choice of this.first()) this.add(choice);
  }

  /** Forces over time, one loop of force over stroke, and how well the run did. @returns {import('./plot.js').Choice[]} */
  first() {
    const { data } = this.app, t = data.column('t'), out = [], at = (name) => data.column(name);
    const names = data.elements.map((element) => element.name).filter((name) => at(`${name}.force`) >= 0);
    for (const name of names.slice(0, 3)) out.push({ x: t, ys: [at(`${name}.force`)] });
    const loop = names.find((name) => at(`${name}.stroke`) >= 0);
    if (loop !== undefined) out.splice(1, 0, { x: at(`${loop}.stroke`), ys: [at(`${loop}.force`)] });
    for (const name of ['gripper.error', 'energy.residual']) {
      if (at(name) < 0) continue;
      out.push({ x: t, ys: [at(name)] });
      break;
    }
    if (!out.length) {
      const some = data.columns.findIndex((column, i) => i !== t && column.name !== 't');
      if (some >= 0) out.push({ x: t, ys: [some] });
    }
    return out;
  }

  /** @param {import('./plot.js').Choice} choice */
  add(choice) {
    const plot = new Plot(this.app, choice, { edit: (one) => this.edit(one), remove: (one) => this.remove(one) });
    this.list.push(plot);
    this.host.insertBefore(plot.node, this.addButton);
    this.app.wake();
    return plot;
  }

  remove(plot) {
    const at = this.list.indexOf(plot);
    this.list.splice(at, 1);
    plot.close();
    // The focus does not fall back to the page.
    (this.list[Math.min(at, this.list.length - 1)]?.node.querySelector('button') ?? this.addButton).focus();
  }

  edit(plot) {
    const { data } = this.app;
    this.editing = plot;
    this.chosen = new Set(plot?.choice.ys ?? []);
    this.search.value = '';
    const options = data.columns.map((column, i) => h('option', { value: String(i), text: title(label(column)) }));
    if (data.column('t') < 0) options.unshift(h('option', { value: '-1', text: 'row' }));
    this.x.replaceChildren(...options);
    this.x.value = String(plot?.choice.x ?? data.column('t'));
    byId('picker-title').textContent = plot ? 'Columns of the plot' : 'New plot';
    this.dialog.returnValue = '';
    this.offer();
    this.dialog.showModal();
    this.search.focus();
  }

  /** Columns whose name or meaning has all words of the search. */
  offer() {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean), rows = [];
    let found = 0;
    this.app.data.columns.forEach((column, i) => {
      const text = `${column.name} ${column.meaning ?? ''} ${column.unit ?? ''}`.toLowerCase();
      if (!words.every((word) => text.includes(word)) || ++found > MOST_LISTED) return;
      const box = h('input', { type: 'checkbox', checked: this.chosen.has(i), onchange: () => (box.checked ? this.chosen.add(i) : this.chosen.delete(i)) });
      rows.push(h('label', { title: title(column.name) }, box, h('span', { class: 'what', text: label(column) }), h('span', { class: 'meaning', text: column.meaning ?? '' })));
    });
    if (!rows.length) rows.push(h('p', { class: 'none', text: 'No column has this name.' }));
    if (found > MOST_LISTED) rows.push(h('p', { class: 'none', text: `${found - MOST_LISTED} more: search to narrow them down.` }));
    this.listing.replaceChildren(...rows);
  }

  take() {
    if (this.dialog.returnValue !== 'take' || !this.chosen.size) return;
    const choice = { x: Number(this.x.value), ys: [...this.chosen].sort((a, b) => a - b) };
    if (!this.editing) this.add(choice).node.scrollIntoView({ block: 'nearest' });
    else {
      this.editing.choice = choice;
      this.editing.setZoom(null);
    }
  }

  /** All curves anew with the next frame. */
  spoil() {
    for (const plot of this.list) plot.dirty = true;
  }

  /** @param {number} time */
  frame(time) {
    for (let i = 0; i < this.list.length; i++) {
      const plot = this.list[i];
      if (plot.dirty) plot.draw();
      plot.cursor(time);
    }
  }
}
