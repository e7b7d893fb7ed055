/** @file Numbers, units, ticks and formulas as text. */

import { plain } from './dom.js';

/** Short but honest: four digits, exponents only where they help. @param {number} v @param {number} digits */
export function number(v, digits = 4) {
  if (!Number.isFinite(v)) return '–';
  if (v === 0) return '0';
  const size = Math.abs(v);
  if (size >= 1e5 || size < 1e-3) {
    const [m, e] = v.toExponential(Math.max(digits - 2, 1)).split('e');
    return `${minus(m.replace(/\.?0+$/, ''))}·10${superscript(Number(e))}`;
  }
  return minus(String(Number(v.toPrecision(digits))));
}

/** Fixed digits, so that changing numbers keep their width. @param {number} v @param {number} digits */
export const fixed = (v, digits) => (Number.isFinite(v) ? minus(v.toFixed(digits)) : '–');

/** @param {string} text */
const minus = (text) => text.replace(/^-/, '−');

/** @param {number} n */
const superscript = (n) => String(n).replace(/[-0-9]/g, (c) => (c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(c)]));

const GREEK = { alpha: 'α', beta: 'β', gamma: 'γ', delta: 'δ', mu: 'μ', tau: 'τ', omega: 'ω', eta: 'η', nu: 'ν', rho: 'ρ', phi: 'φ', sigma: 'σ', lambda: 'λ', epsilon: 'ε' };

/** "N*s^alpha/m" as it is printed. @param {string} unit */
export function unitText(unit) {
  if (!unit || unit === '1') return '';
  return unit.replace(/\*/g, '·').replace(/\b(alpha|beta|gamma)\b/g, (w) => GREEK[w]).replace(/\^(-?\d)/g, (_, n) => superscript(n)).replace(/\^(α|β|γ|n\b)/g, (_, g) => ({ α: 'ᵅ', β: 'ᵝ', γ: 'ᵞ', n: 'ⁿ' })[g]);
}

/** A name with its unit. @param {{name: string, unit: string}} column */
export const label = (column) => (unitText(column.unit) ? `${column.name} / ${unitText(column.unit)}` : column.name);

/** Writes a formula into a node: Greek letters, raised exponents and lowered indices. Only text nodes are made. @param {Element} node @param {string} text */
export function formula(node, text) {
  node.replaceChildren();
  const cut = plain(text.length > 2000 ? `${text.slice(0, 2000)}…` : text);
  const pattern = /([_^])(\([^()]{1,40}\)|[A-Za-z0-9]+)|([A-Za-z]+)|([^A-Za-z_^]+|[_^])/g;
  for (const [, mark, small, word, rest] of cut.matchAll(pattern)) {
    if (mark) {
      const tag = document.createElement(mark === '_' ? 'sub' : 'sup');
      tag.textContent = GREEK[small] ?? small;
      node.append(tag);
    } else if (word) {
      const i = document.createElement('i');
      i.textContent = GREEK[word] ?? word;
      node.append(i);
    } else node.append(rest);
  }
}

/** The step of ticks 1, 2 or 5 times a power of ten. @param {number} span @param {number} count */
export function step(span, count) {
  const raw = span / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(raw));
  const m = raw / power;
  return (m < 1.5 ? 1 : m < 3.5 ? 2 : m < 7.5 ? 5 : 10) * power;
}

/** Ticks of an axis with their texts; a common power of ten goes out. @param {number} low @param {number} high @param {number} count */
export function ticks(low, high, count) {
  const d = step(high - low, count);
  const out = [];
  if (!(d > 0) || !Number.isFinite(d)) return { values: out, text: () => '', power: 0 };
  for (let k = Math.ceil(low / d - 1e-9); k * d <= high + 1e-9 * d && out.length < 50; k++) out.push(k * d);
  const size = Math.max(Math.abs(low), Math.abs(high));
  const e = Math.floor(Math.log10(size) + 1e-9);
  const power = e >= 5 || e <= -4 ? e : 0;
  const digits = Math.min(Math.max(0, -Math.floor(Math.log10(d) + 1e-9) + power), 12);
  return { values: out, text: (v) => fixed(Math.abs(v) < 1e-9 * d ? 0 : v / 10 ** power, digits), power: power };
}

/** @param {number} power */
export const powerText = (power) => (power ? `·10${superscript(power)}` : '');
