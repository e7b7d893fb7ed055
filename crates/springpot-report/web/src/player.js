/** @file The time that is shown, and how it goes on. */

/** Speeds around the one that fits the run, and real time. @param {number} own */
export function speeds(own) {
  const list = new Set([1, own]);
  for (let k = Math.floor(Math.log10(own)) - 1; k <= Math.log10(own) + 1; k++) for (const m of [1, 2, 5]) {
    const v = Number(`${m}e${k}`);
    if (v >= 0.0999 * own && v <= 10.01 * own) list.add(v);
  }
  return [...list].sort((a, b) => a - b);
}

export class Player {
  /** @param {() => import('./data.js').Case[]} cases that are shown */
  constructor(cases) {
    this.cases = cases;
    this.time = 0;
    this.playing = false;
    this.loop = true;
    this.speed = 1;
    this.start = 0;
    this.end = 0;
    /** @type {(() => void)[]} */
    this.listeners = [];
  }

  /** The span of all shown cases. */
  fit() {
    const cases = this.cases().filter((one) => one.rows > 0);
    this.start = cases.length ? Math.min(...cases.map((one) => one.start)) : 0;
    this.end = cases.length ? Math.max(...cases.map((one) => one.end)) : 0;
    this.time = Math.min(Math.max(this.time, this.start), this.end);
  }

  /** Real time, unless that is over at once or never. */
  choose() {
    const length = this.end - this.start;
    this.speed = length > 0 && (length < 2 || length > 60) ? length / 8 : 1;
    return this.speed;
  }

  /** @param {number} t */
  seek(t) {
    const to = Math.min(Math.max(t, this.start), this.end);
    this.time = Number.isFinite(to) ? to : this.start;
    this.tell();
  }

  toggle(on = !this.playing) {
    this.playing = on && this.end > this.start;
    if (this.playing && this.time >= this.end) this.time = this.start;
    this.tell();
  }

  /** Some rows of the first shown case on or back. @param {number} rows */
  step(rows) {
    const one = this.cases().find((each) => each.rows > 1);
    this.playing = false;
    if (!one) return this.tell();
    const row = one.rowAt(this.time);
    let to = Math.min(Math.max(row + rows, 0), one.rows - 1);
    // Back from between two rows is to the row before; rows at the same time count as one.
    if (rows < 0 && this.time > one.time[row]) to = Math.min(to + 1, one.rows - 1);
    while (rows > 0 && to < one.rows - 1 && one.time[to] <= this.time) to++;
    return this.seek(one.time[to]);
  }

  /** @param {number} seconds since the last frame */
  advance(seconds) {
    // A tab that was away does not jump.
    let t = this.time + Math.min(seconds, 0.25) * this.speed;
    if (t >= this.end) {
      if (this.loop && this.end > this.start) t = this.start + ((t - this.start) % (this.end - this.start));
      else {
        t = this.end;
        this.playing = false;
      }
    }
    this.time = t;
    this.tell();
  }

  tell() {
    for (let i = 0; i < this.listeners.length; i++) this.listeners[i]();
  }
}
