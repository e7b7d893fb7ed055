/** @file The common range of the elements' colours over all shown cases, per unit. */

import { diverging, sequential } from './colors.js';
import { parts } from './elements.js';

/** @typedef {'force'|'stored'} Mode */

export class Colors {
  /** @param {import('./data.js').Data} data */
  constructor(data) {
    this.data = data;
    /** @type {Mode} */
    this.mode = 'force';
    this.map = diverging;
    /** Largest size per column. @type {Float64Array} */
    this.limit = new Float64Array(data.columns.length);
    /** @type {Map<string, number>} by unit */
    this.units = new Map();
    this.peaks = new Map();
  }

  /** The largest size of a column in a case; remembered until rows come in. */
  peak(one, column) {
    const key = `${one.index}:${column}`, known = this.peaks.get(key);
    if (known && known.version === one.version) return known.value;
    let value = 0;
    const data = one.data[column];
    for (let i = 0; i < one.rows; i++) {
      const size = Math.abs(data[i]);
      if (size > value && size < Infinity) value = size;
    }
    this.peaks.set(key, { version: one.version, value });
    return value;
  }

  /** @param {Mode} mode @param {import('./data.js').Case[]} cases */
  set(mode, cases) {
    this.mode = mode;
    this.map = mode === 'force' ? diverging : sequential;
    this.units.clear();
    const columns = new Set();
    for (const one of cases) {
      for (const element of this.data.scenes[one.scene]?.elements ?? []) {
        for (const name of parts(element)) {
          const column = this.data.column(`${name}.${mode}`);
          if (column < 0) continue;
          columns.add(column);
          const { unit } = this.data.columns[column];
          this.units.set(unit, Math.max(this.units.get(unit) ?? 0, this.peak(one, column)));
        }
      }
    }
    for (const column of columns) this.limit[column] = this.units.get(this.data.columns[column].unit) || 1;
  }

  /** The entry of the colour map for an element at a moment. */
  entry(view, one, row, s) {
    const columns = this.mode === 'force' ? view.forces : view.stores;
    let share = NaN, size = -1;
    for (let k = 0; k < columns.length; k++) {
      const value = one.value(columns[k], row, s) / this.limit[columns[k]];
      if (Math.abs(value) > size) { size = Math.abs(value); share = value; }
    }
    if (!(size >= 0)) return this.mode === 'force' ? this.map.last / 2 : 0;
    return this.map.entry(this.mode === 'force' ? 0.5 + 0.5 * share : share);
  }
}
