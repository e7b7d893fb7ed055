/** @file The page's data: parsed, decoded, and grown while a run goes on. */

/**
 * @typedef {{name: string, unit: string, meaning: string}} Column
 * @typedef {{name: string, t: number}} Mark
 * @typedef {{name: string, column: string, value: number, unit: string}} Metric
 */

/** @param {string} text base64 @returns {Uint8Array} */
export function bytes(text) {
  if (typeof Uint8Array.fromBase64 === 'function') return Uint8Array.fromBase64(text);
  const raw = atob(text);
  const out = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) out[i] = raw.charCodeAt(i);
  return out;
}

/** One case of a sweep: its rows, column by column. */
export class Case {
  /** @param {any} raw @param {Column[]} columns */
  constructor(raw, columns) {
    this.index = raw.index ?? 0;
    /** @type {string} */
    this.name = raw.name || '';
    /** @type {Record<string, number|string>} */
    this.parameters = raw.parameters ?? {};
    /** @type {string} */
    this.status = raw.status ?? 'running';
    /** @type {string|null} */
    this.error = raw.error ?? null;
    this.scene = raw.scene ?? 0;
    /** @type {Mark[]} */
    this.events = raw.events ?? [];
    /** @type {Metric[]} */
    this.metrics = raw.metrics ?? [];
    /** Raised when rows come in, so that what was drawn from them is drawn anew. */
    this.version = 0;
    const data = raw.data ? bytes(raw.data) : new Uint8Array(0);
    const floats = new Float32Array(data.buffer, data.byteOffset, data.byteLength >> 2);
    // A shorter block than promised is believed, not the promise.
    this.rows = columns.length ? Math.min(raw.rows ?? 0, Math.floor(floats.length / columns.length)) : 0;
    /** @type {Float32Array[]} */
    this.data = columns.map((_, c) => floats.subarray(c * this.rows, (c + 1) * this.rows));
    this.room = this.rows;
    const t = columns.findIndex((column) => column.name === 't');
    this.timeColumn = t;
    this.setTime();
  }

  /** Without a column of time the rows are counted. */
  setTime() {
    this.time = this.timeColumn >= 0 ? this.data[this.timeColumn] : Float32Array.from({ length: this.rows }, (_, i) => i);
  }

  get end() {
    return this.rows ? this.time[this.rows - 1] : 0;
  }

  get start() {
    return this.rows ? this.time[0] : 0;
  }

  /** The last row not after t (0 before the first). @param {number} t */
  rowAt(t) {
    let low = 0;
    let high = this.rows;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time[middle] <= t) low = middle + 1;
      else high = middle;
    }
    return Math.max(low - 1, 0);
  }

  /** How far t lies between a row and the next, 0 … 1. @param {number} row @param {number} t */
  between(row, t) {
    if (row + 1 >= this.rows) return 0;
    const a = this.time[row];
    const b = this.time[row + 1];
    return b > a ? Math.min(Math.max((t - a) / (b - a), 0), 1) : 0;
  }

  /** The value of a column, linear between rows; NaN where there is none. @param {number} column @param {number} row @param {number} s */
  value(column, row, s) {
    if (column < 0 || row >= this.rows) return NaN;
    const data = this.data[column];
    const a = data[row];
    if (s === 0) return a;
    const b = data[row + 1];
    return a + s * (b - a);
  }

  /** Appends rows of a running case. @param {(number|null)[][]} rows */
  append(rows) {
    if (!rows.length) return;
    const needed = this.rows + rows.length;
    if (needed > this.room) {
      this.room = Math.max(needed, 2 * this.room, 256);
      this.data = this.data.map((old) => {
        const grown = new Float32Array(this.room);
        grown.set(old.subarray(0, this.rows));
        return grown;
      });
    }
    rows.forEach((row, i) => {
      for (let c = 0; c < this.data.length; c++) this.data[c][this.rows + i] = row[c] ?? NaN;
    });
    this.rows = needed;
    this.version++;
    this.setTime();
  }
}

/** Everything the page shows. */
export class Data {
  /** @param {any} raw */
  constructor(raw) {
    this.raw = raw;
    /** @type {string} */
    this.title = raw.title || raw.name || 'Run';
    this.name = raw.name ?? '';
    /** @type {string} */
    this.status = raw.status ?? 'done';
    this.version = raw.version ?? '';
    /** @type {string[]} */
    this.notes = raw.notes ?? [];
    /** @type {Column[]} */
    this.columns = raw.columns ?? [];
    this.scenes = raw.scenes ?? [];
    this.meshes = raw.meshes ?? [];
    this.elements = raw.elements ?? [];
    /** @type {Map<string, number>} */
    this.byName = new Map(this.columns.map((column, i) => [column.name, i]));
    /** @type {Case[]} */
    this.cases = (raw.cases ?? []).map((one) => new Case(one, this.columns));
    /** @type {string|null} */
    this.follow = raw.follow ?? null;
    for (const one of raw.cases ?? []) delete one.data; // the decoded copy is enough
  }

  /** @param {string} name @returns {number} index of a column, or −1 */
  column(name) {
    return this.byName.get(name) ?? -1;
  }

  /** A case that a running sweep has begun. @param {any} raw */
  addCase(raw) {
    if (this.cases.some((one) => one.index === raw.index)) return null;
    const one = new Case({ status: 'running', ...raw }, this.columns);
    this.cases.push(one);
    return one;
  }

  /** What a case is called. @param {Case} one */
  caseName(one) {
    return one.name || (this.cases.length > 1 ? `case ${one.index + 1}` : this.name || 'run');
  }
}
