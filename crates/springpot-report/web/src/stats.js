/** @file What a frame costs: script time and frames per second over the last frames. */

const KEPT = 240;

export class Stats {
  constructor() {
    this.script = new Float64Array(KEPT);
    this.gap = new Float64Array(KEPT);
    this.count = 0;
    this.gaps = 0;
    this.last = 0;
  }

  /** @param {number} begin @param {number} end @param {boolean} running frames follow each other */
  add(begin, end, running) {
    this.script[this.count++ % KEPT] = end - begin;
    if (running && this.last) this.gap[this.gaps++ % KEPT] = begin - this.last;
    this.last = running ? begin : 0;
  }

  clear() {
    this.count = 0;
    this.gaps = 0;
    this.last = 0;
  }

  report() {
    const n = Math.min(this.count, KEPT), sorted = Array.from(this.script.subarray(0, n)).sort((a, b) => a - b);
    const gaps = this.gap.subarray(0, Math.min(this.gaps, KEPT));
    const mean = (list) => (list.length ? list.reduce((a, b) => a + b, 0) / list.length : 0);
    const round = (v) => Math.round(v * 1000) / 1000;
    return {
      count: this.count,
      scriptMs: { median: round(sorted[n >> 1] ?? 0), mean: round(mean(sorted)), max: round(sorted[n - 1] ?? 0), p95: round(sorted[Math.floor(0.95 * (n - 1))] ?? 0) },
      fps: gaps.length ? Math.round(10000 / mean(gaps)) / 10 : 0,
    };
  }
}
