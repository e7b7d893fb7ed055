/** @file Geometry of the elements' signs. A vertex moves with a share of the element's length and of its twist, so that a sign stretches without being built anew. */

import { BufferAttribute, BufferGeometry } from 'three';

/** Gathers triangles: place, normal, share of the length, share of the twist, and how much of the element's colour. */
class Sheet {
  constructor() {
    this.position = [];
    this.normal = [];
    this.along = [];
    this.turn = [];
    this.tone = [];
    this.index = [];
  }

  vertex(x, y, z, nx, ny, nz, along, turn, tone) {
    this.position.push(x, y, z);
    this.normal.push(nx, ny, nz);
    this.along.push(along);
    this.turn.push(turn);
    this.tone.push(tone, tone, tone);
    return this.along.length - 1;
  }

  /** A lathe about a line parallel to z: rings [along, z, radius, normal's z]. */
  lathe(x, rings, tone, segments = 20) {
    for (let k = 0; k + 1 < rings.length; k++) {
      const first = this.along.length;
      for (const [along, z, radius, nz] of [rings[k], rings[k + 1]]) {
        const flat = Math.sqrt(Math.max(1 - nz * nz, 0));
        for (let i = 0; i <= segments; i++) {
          const c = Math.cos((2 * Math.PI * i) / segments), s = Math.sin((2 * Math.PI * i) / segments);
          this.vertex(x + radius * c, radius * s, z, flat * c, flat * s, nz, along, 0, tone);
        }
      }
      for (let i = 0; i < segments; i++) {
        const a = first + i, b = a + segments + 1;
        this.index.push(a, a + 1, b, b, a + 1, b + 1);
      }
    }
  }

  /** A straight rod with closed ends from one place to another along the element. */
  rod(x, [a, za], [b, zb], radius, tone, segments = 12) {
    this.lathe(x, [[a, za, 0, -1], [a, za, radius, -1]], tone, segments);
    this.lathe(x, [[a, za, radius, 0], [b, zb, radius, 0]], tone, segments);
    this.lathe(x, [[b, zb, radius, 1], [b, zb, 0, 1]], tone, segments);
  }

  ball(x, [a, z], radius, tone) {
    const rings = [];
    for (let k = 0; k <= 10; k++) {
      const f = -Math.PI / 2 + (Math.PI * k) / 10;
      rings.push([a, z + radius * Math.sin(f), radius * Math.cos(f), Math.sin(f)]);
    }
    this.lathe(x, rings, tone, 16);
  }

  /** A tube about a line given by centre(u) → [x, y, z, along, turn] and its tangent. */
  tube(count, at, wire, tone, sides = 8) {
    const first = this.along.length;
    const c = [0, 0, 0, 0, 0], before = [0, 0, 0, 0, 0], after = [0, 0, 0, 0, 0];
    for (let i = 0; i <= count; i++) {
      at(i / count, c);
      at(Math.max(i - 0.5, 0) / count, before);
      at(Math.min(i + 0.5, count) / count, after);
      // at() also gives the height at the usual length in [5], for the tangent only.
      let tx = after[0] - before[0], ty = after[1] - before[1], tz = after[5] - before[5];
      const l = Math.hypot(tx, ty, tz) || 1;
      tx /= l; ty /= l; tz /= l;
      let rx = c[0] - c[6], ry = c[1], rz = 0;
      const dot = rx * tx + ry * ty;
      rx -= dot * tx; ry -= dot * ty; rz -= dot * tz;
      const rl = Math.hypot(rx, ry, rz);
      if (rl > 1e-12) { rx /= rl; ry /= rl; rz /= rl; } else { rx = 1; ry = 0; rz = 0; }
      const bx = ty * rz - tz * ry, by = tz * rx - tx * rz, bz = tx * ry - ty * rx;
      for (let k = 0; k <= sides; k++) {
        const f = (2 * Math.PI * k) / sides, u = Math.cos(f), v = Math.sin(f);
        const nx = u * rx + v * bx, ny = u * ry + v * by, nz = u * rz + v * bz;
        this.vertex(c[0] + wire * nx, c[1] + wire * ny, c[2] + wire * nz, nx, ny, nz, c[3], c[4], tone);
      }
    }
    for (let i = 0; i < count; i++) {
      for (let k = 0; k < sides; k++) {
        const a = first + i * (sides + 1) + k, b = a + sides + 1;
        this.index.push(a, a + 1, b, b, a + 1, b + 1);
      }
    }
  }

  /** A flat four-sided double pyramid: the rhombus of a springpot. */
  rhombus(x, along, wide, long, tone) {
    const corners = [[wide, 0], [0, wide], [-wide, 0], [0, -wide]];
    for (const end of [-1, 1]) {
      for (let k = 0; k < 4; k++) {
        const [ax, ay] = corners[k], [bx, by] = corners[(k + 1) % 4];
        const n = [(ax + bx) / wide, (ay + by) / wide, (end * wide) / long], l = Math.hypot(...n);
        const [nx, ny, nz] = n.map((v) => v / l);
        const i = this.vertex(x + ax, ay, 0, nx, ny, nz, along, 0, tone);
        this.vertex(x + bx, by, 0, nx, ny, nz, along, 0, tone);
        this.vertex(x, 0, end * long, nx, ny, nz, along, 0, tone);
        if (end > 0) this.index.push(i, i + 1, i + 2);
        else this.index.push(i + 1, i, i + 2);
      }
    }
  }

  /** A bar across, on which parts side by side end. */
  plate(from, to, along, thick, tone) {
    const sides = 10, first = this.along.length;
    for (const [x] of [[from], [to]]) {
      for (let i = 0; i <= sides; i++) {
        const c = Math.cos((2 * Math.PI * i) / sides), s = Math.sin((2 * Math.PI * i) / sides);
        this.vertex(x, thick * c, thick * s, 0, c, s, along, 0, tone);
      }
    }
    for (let i = 0; i < sides; i++) {
      const a = first + i, b = a + sides + 1;
      this.index.push(a, a + 1, b, b, a + 1, b + 1);
    }
    this.ball(from, [along, 0], thick, tone);
    this.ball(to, [along, 0], thick, tone);
  }

  /** @returns {BufferGeometry} */
  geometry() {
    const out = new BufferGeometry();
    out.setAttribute('position', new BufferAttribute(new Float32Array(this.position), 3));
    out.setAttribute('normal', new BufferAttribute(new Float32Array(this.normal), 3));
    out.setAttribute('along', new BufferAttribute(new Float32Array(this.along), 1));
    out.setAttribute('turn', new BufferAttribute(new Float32Array(this.turn), 1));
    out.setAttribute('color', new BufferAttribute(new Float32Array(this.tone), 3));
    out.setIndex(this.index);
    return out;
  }
}

const parallel = (sign) => (typeof sign === 'object' && sign?.parallel?.length ? sign.parallel : null);
const series = (sign) => (typeof sign === 'object' && sign?.series?.length ? sign.series : null);

/** How many signs lie side by side. @param {any} sign @returns {number} */
export function rails(sign) {
  if (parallel(sign)) return parallel(sign).reduce((n, part) => n + rails(part), 0);
  if (series(sign)) return Math.max(...series(sign).map(rails));
  return 1;
}

/** How many signs lie one behind the other. @param {any} sign @returns {number} */
function links(sign) {
  if (parallel(sign)) return Math.max(...parallel(sign).map(links));
  if (series(sign)) return series(sign).reduce((n, part) => n + links(part), 0);
  return 1;
}

/** Tones: all of the element's colour, or a darker shade for rods. */
const FULL = 1, ROD = 0.42;

/** Draws signs into a sheet; length is the usual one of the whole element, radius that of one sign. */
class Pen {
  constructor(sheet, length, radius) {
    this.sheet = sheet;
    this.length = length;
    this.radius = radius;
    this.wire = 0.17 * radius;
    this.thin = 0.13 * radius;
  }

  lead(x, a, b) {
    this.sheet.rod(x, [a, 0], [b, 0], this.thin, ROD, 10);
  }

  part(sign, a, b, x) {
    const span = b - a;
    if (parallel(sign)) return this.beside(parallel(sign), a, b, x);
    if (series(sign)) {
      const parts = series(sign), all = parts.reduce((n, part) => n + links(part), 0);
      let from = a;
      parts.forEach((part, i) => {
        const to = from + (span * links(part)) / all;
        this.part(part, from, to, x);
        if (i) this.sheet.ball(x, [from, 0], 1.9 * this.thin, ROD);
        from = to;
      });
      return undefined;
    }
    if (sign === 'dashpot') return this.dashpot(a, b, x);
    if (sign === 'springpot') return this.springpot(a, b, x);
    if (sign === 'source') return this.source(a, b, x);
    return this.spring(a, b, x);
  }

  beside(parts, a, b, x) {
    const edge = Math.min(0.13, (1.6 * this.radius) / (this.length * (b - a))) * (b - a);
    const pitch = 2.55 * this.radius, all = parts.reduce((n, part) => n + rails(part), 0);
    this.lead(x, a, a + edge);
    this.lead(x, b - edge, b);
    let used = 0;
    const places = parts.map((part) => {
      const n = rails(part), at = x + (used + n / 2 - all / 2) * pitch;
      used += n;
      return at;
    });
    for (const end of [a + edge, b - edge]) this.sheet.plate(places[0], places[places.length - 1], end, 1.5 * this.thin, ROD);
    parts.forEach((part, i) => this.part(part, a + edge, b - edge, places[i]));
  }

  spring(a, b, x) {
    const span = b - a, r = this.radius, long = span * this.length;
    const coil = Math.min(0.74, (16 * r) / long), from = a + (span * (1 - coil)) / 2, to = b - (span * (1 - coil)) / 2;
    const turns = Math.max(4, Math.min(11, Math.round((coil * long) / (1.05 * r))));
    this.lead(x, a, from);
    this.lead(x, to, b);
    this.sheet.tube(turns * 22, (u, out) => {
      // The wire comes from the middle line and goes back to it.
      const edge = Math.min(u, 1 - u) * turns, radius = r * (edge < 0.35 ? Math.sin((edge / 0.35) * Math.PI / 2) : 1);
      const f = 2 * Math.PI * turns * u, s = Math.min(Math.max((u - 0.15 / turns) / (1 - 0.3 / turns), 0), 1);
      out[0] = x + radius * Math.cos(f); out[1] = radius * Math.sin(f); out[2] = 0;
      out[3] = from + (to - from) * s; out[4] = 0; out[5] = out[3] * this.length; out[6] = x;
    }, this.wire, FULL);
  }

  dashpot(a, b, x) {
    const span = b - a, r = this.radius, long = span * this.length;
    const tall = Math.min(0.42 * long, 7 * r), from = a + (span * (1 - tall / long)) * 0.42, wide = 0.78 * r;
    this.lead(x, a, from);
    // The pot is shut below and open above; its wall has two sides.
    this.sheet.lathe(x, [[from, 0, 0, -1], [from, 0, wide, -1]], FULL, 28);
    this.sheet.lathe(x, [[from, 0, wide, 0], [from, tall, wide, 0]], FULL, 28);
    this.sheet.lathe(x, [[from, tall, wide, 1], [from, tall, 0.2 * r, 1]], 0.7, 28);
    for (const z of [0.06 * tall, 0.94 * tall]) this.sheet.lathe(x, [[from, z - 0.05 * tall, wide * 1.12, 0], [from, z + 0.05 * tall, wide * 1.12, 0]], 0.7, 28);
    for (const z of [0.01 * tall, 0.11 * tall, 0.89 * tall, 0.99 * tall]) {
      const up = z > 0.5 * tall ? z > 0.95 * tall : z > 0.06 * tall;
      this.sheet.lathe(x, up ? [[from, z, wide * 1.12, 1], [from, z, wide * 0.98, 1]] : [[from, z, wide * 0.98, -1], [from, z, wide * 1.12, -1]], 0.7, 28);
    }
    // The rod hangs on the far end and keeps its length.
    const rod = b * this.length - (from * this.length + 0.5 * tall);
    this.sheet.rod(x, [b, -rod], [b, 0], 1.5 * this.thin, ROD, 12);
  }

  springpot(a, b, x) {
    const r = this.radius, long = (b - a) * this.length, half = Math.min(0.3 * long, 2.1 * r), middle = (a + b) / 2;
    this.sheet.rod(x, [a, 0], [middle, -half], this.thin, ROD, 10);
    this.sheet.rod(x, [middle, half], [b, 0], this.thin, ROD, 10);
    this.sheet.rhombus(x, middle, 1.12 * r, half * 1.04, FULL);
  }

  source(a, b, x) {
    const r = this.radius, middle = (a + b) / 2;
    this.lead(x, a, b);
    this.sheet.ball(x, [middle, 0], 0.85 * r, FULL);
    this.sheet.lathe(x, [[middle, -0.16 * r, 0.98 * r, 0], [middle, 0.16 * r, 0.98 * r, 0]], 0.55, 28);
    this.sheet.lathe(x, [[middle, -0.16 * r, 0.7 * r, -1], [middle, -0.16 * r, 0.98 * r, -1]], 0.55, 28);
    this.sheet.lathe(x, [[middle, 0.16 * r, 0.98 * r, 1], [middle, 0.16 * r, 0.7 * r, 1]], 0.55, 28);
  }
}

/** The sign of a straight element along z. @param {any} sign @param {number} length @param {number} radius of the whole sign */
export function straight(sign, length, radius) {
  const sheet = new Sheet(), n = rails(sign);
  const one = radius * (n === 1 ? 1 : n === 2 ? 0.72 : n === 3 ? 0.58 : 1.7 / n);
  const pen = new Pen(sheet, length, one);
  pen.part(sign, 0, 1, 0);
  sheet.ball(0, [0, 0], 0.34 * radius, ROD);
  sheet.ball(0, [1, 0], 0.34 * radius, ROD);
  return sheet.geometry();
}

/** A spiral about z: its inner end turns with the body, the outer one stays with the parent. @param {number} inner @param {number} outer @param {number} wire */
export function spiral(inner, outer, wire) {
  const sheet = new Sheet(), turns = 3.25;
  sheet.tube(150, (u, out) => {
    const f = 2 * Math.PI * turns * u, radius = inner + (outer - inner) * u;
    out[0] = radius * Math.cos(f); out[1] = radius * Math.sin(f); out[2] = 0; out[3] = 0; out[4] = u; out[5] = 0; out[6] = 0;
  }, wire, FULL, 8);
  const end = 2 * Math.PI * turns, first = sheet.along.length;
  sheet.ball(0, [0, 0], 1.9 * wire, ROD);
  for (let i = first; i < sheet.along.length; i++) {
    sheet.position[3 * i] += outer * Math.cos(end);
    sheet.position[3 * i + 1] += outer * Math.sin(end);
    sheet.turn[i] = 1;
  }
  return sheet.geometry();
}

/** A ring about z. @param {number} radius @param {number} wire @param {number} tone */
export function ring(radius, wire, tone = FULL) {
  const sheet = new Sheet();
  sheet.tube(56, (u, out) => {
    out[0] = radius * Math.cos(2 * Math.PI * u); out[1] = radius * Math.sin(2 * Math.PI * u); out[2] = 0; out[3] = 0; out[4] = 0; out[5] = 0; out[6] = 0;
  }, wire, tone, 12);
  return sheet.geometry();
}

/** A straight piece of a cable along z. @param {number} radius */
export function cablePiece(radius) {
  const sheet = new Sheet();
  sheet.rod(0, [0, 0], [1, 0], radius, FULL, 10);
  sheet.ball(0, [1, 0], 1.7 * radius, 0.8);
  sheet.ball(0, [0, 0], 1.7 * radius, 0.8);
  return sheet.geometry();
}
