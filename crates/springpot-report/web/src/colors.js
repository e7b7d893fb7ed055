/** @file Colour maps and palettes, told apart by colour-blind readers. */

/** Compression blue, zero grey, tension orange-red; even in lightness on both sides. */
const DIVERGING = ['#0b4fa8', '#2f7fd1', '#7badd9', '#a9adb3', '#e2a276', '#d96a28', '#b23a06'];
/** Viridis. */
const SEQUENTIAL = ['#440154', '#482878', '#3e4a89', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b', '#fde725'];
/** Plasma, for cases that are ordered by a number. */
const ORDERED = ['#41049d', '#6a00a8', '#8f0da4', '#b12a90', '#cc4778', '#e16462', '#f2844b', '#fca636', '#fcce25', '#f0f921'];
/** Okabe and Ito's, without black and the yellow that is too pale on white. */
const DISTINCT_LIGHT = ['#0072b2', '#d55e00', '#008f68', '#b8568f', '#b37700', '#2e8fc4', '#6a51a3', '#5d6570'];
const DISTINCT_DARK = ['#56b4e9', '#ff8a3d', '#2fcf9f', '#e79cc8', '#f0b429', '#9fd4f5', '#b8a5ee', '#b4bcc8'];

/** @param {string} hex */
const parse = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));

/** @param {number[]} rgb */
const hex = (rgb) => `#${rgb.map((v) => Math.round(v).toString(16).padStart(2, '0')).join('')}`;

/** @param {string[]} stops @param {number} s 0 … 1 */
function mix(stops, s) {
  const at = Math.min(Math.max(s, 0), 1) * (stops.length - 1);
  const i = Math.min(Math.floor(at), stops.length - 2);
  const a = parse(stops[i]), b = parse(stops[i + 1]);
  return a.map((v, k) => v + (at - i) * (b[k] - v));
}

/** sRGB to linear, as the renderer wants its colours. @param {number} v 0 … 255 */
const linear = (v) => (v <= 10.31475 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);

/** A map as tables, so that a frame makes no objects. */
class ColorMap {
  /** @param {string[]} stops */
  constructor(stops) {
    const n = 257; // odd: zero has an entry of its own
    this.last = n - 1;
    this.hex = Array.from({ length: n }, (_, i) => hex(mix(stops, i / (n - 1))));
    this.linear = new Float32Array(3 * n);
    for (let i = 0; i < n; i++) parse(this.hex[i]).forEach((v, k) => { this.linear[3 * i + k] = linear(v); });
  }

  /** @param {number} s 0 … 1; not a number: the middle or low end is the caller's choice */
  entry(s) {
    return s >= 0 ? Math.round(Math.min(s, 1) * this.last) : 0;
  }

  /** Colours in CSS from low to high. */
  gradient(direction = 'to right') {
    const stops = Array.from({ length: 17 }, (_, i) => this.hex[Math.round((i / 16) * this.last)]);
    return `linear-gradient(${direction}, ${stops.join(', ')})`;
  }
}

export const diverging = new ColorMap(DIVERGING);
export const sequential = new ColorMap(SEQUENTIAL);

/** The colour of one of several cases. Ordered ones go from dark to light. @param {number} i @param {number} n @param {boolean} ordered @param {boolean} dark */
export function caseColor(i, n, ordered, dark) {
  if (!ordered && i < 8) return (dark ? DISTINCT_DARK : DISTINCT_LIGHT)[i % 8];
  const s = n > 1 ? i / (n - 1) : 0;
  return hex(mix(ORDERED, dark ? 0.3 + 0.68 * s : 0.02 + 0.64 * s));
}

/** The colour of one of several columns of one case. @param {number} i @param {boolean} dark */
export const columnColor = (i, dark) => (dark ? DISTINCT_DARK : DISTINCT_LIGHT)[i % 8];

/** Dashes of columns where colours tell cases. */
export const DASHES = [[], [7, 4], [2, 3], [9, 3, 2, 3], [12, 4], [4, 4]];
