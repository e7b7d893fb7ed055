/** @file Geometry of bodies: meshes with creased normals, primitives, and everything of a body merged into one. */

import { BufferAttribute, BufferGeometry, Color, CylinderGeometry, Euler, Matrix3, Matrix4, Quaternion, SphereGeometry, BoxGeometry, CapsuleGeometry, Vector3 } from 'three';
import { bytes } from './data.js';

/** Faces that meet at less than this angle look smooth. */
const CREASE = Math.cos((38 * Math.PI) / 180);

/** Triangles around one place that are looked at for a normal: a fan of very many would take the square of their number. */
const MOST_AROUND = 64;

/** Triangles with normals, shared corners smoothed unless an edge is sharp. @param {any} mesh of the page's data: what has one colour @returns {BufferGeometry} */
export function meshGeometry(mesh) {
  const raw = bytes(mesh.positions), list = bytes(mesh.triangles);
  const packed = new Uint16Array(raw.buffer, raw.byteOffset, raw.byteLength >> 1);
  const triangles = new Uint32Array(list.buffer, list.byteOffset, list.byteLength >> 2);
  const vertices = Math.floor(packed.length / 3);
  // Corners at one place are one vertex, also where the file repeats them per triangle.
  const seen = new Map(), weld = new Uint32Array(vertices);
  for (let v = 0; v < vertices; v++) {
    const key = packed[3 * v] * 4294967296 + packed[3 * v + 1] * 65536 + packed[3 * v + 2];
    const first = seen.get(key);
    if (first === undefined) seen.set(key, v);
    weld[v] = first ?? v;
  }
  const n = Math.floor(triangles.length / 3);
  const place = (v, k) => mesh.low[k] + (mesh.size[k] * packed[3 * v + k]) / 65535;
  const positions = new Float32Array(9 * n), faces = new Float32Array(3 * n), start = new Uint32Array(vertices + 1);
  for (let t = 0; t < n; t++) {
    for (let c = 0; c < 3; c++) {
      const v = Math.min(triangles[3 * t + c], vertices - 1);
      start[weld[v] + 1]++;
      for (let k = 0; k < 3; k++) positions[9 * t + 3 * c + k] = place(v, k);
    }
    const p = positions, i = 9 * t;
    const ax = p[i + 3] - p[i], ay = p[i + 4] - p[i + 1], az = p[i + 5] - p[i + 2];
    const bx = p[i + 6] - p[i], by = p[i + 7] - p[i + 1], bz = p[i + 8] - p[i + 2];
    faces[3 * t] = ay * bz - az * by; faces[3 * t + 1] = az * bx - ax * bz; faces[3 * t + 2] = ax * by - ay * bx;
  }
  for (let v = 0; v < vertices; v++) start[v + 1] += start[v];
  const fill = start.slice(0, vertices), around = new Uint32Array(3 * n);
  for (let i = 0; i < 3 * n; i++) around[fill[weld[Math.min(triangles[i], vertices - 1)]]++] = Math.floor(i / 3);
  const length = new Float32Array(n);
  for (let t = 0; t < n; t++) length[t] = Math.hypot(faces[3 * t], faces[3 * t + 1], faces[3 * t + 2]) || 1e-30;
  const normals = new Float32Array(9 * n);
  for (let t = 0; t < n; t++) {
    for (let c = 0; c < 3; c++) {
      const v = weld[Math.min(triangles[3 * t + c], vertices - 1)];
      let x = 0, y = 0, z = 0;
      if (start[v + 1] - start[v] > MOST_AROUND) { x = faces[3 * t]; y = faces[3 * t + 1]; z = faces[3 * t + 2]; }
      for (let k = start[v], last = Math.min(start[v + 1], k + MOST_AROUND); k < last; k++) {
        const o = around[k];
        const dot = (faces[3 * o] * faces[3 * t] + faces[3 * o + 1] * faces[3 * t + 1] + faces[3 * o + 2] * faces[3 * t + 2]) / (length[o] * length[t]);
        if (dot < CREASE && o !== t) continue;
        x += faces[3 * o]; y += faces[3 * o + 1]; z += faces[3 * o + 2];
      }
      const l = Math.hypot(x, y, z) || 1;
      normals.set([x / l, y / l, z / l], 9 * t + 3 * c);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new BufferAttribute(normals, 3));
  return geometry;
}

/** @param {number[]} origin @param {number[]} rpy @param {number[]} [scale] */
export function matrix(origin = [0, 0, 0], rpy = [0, 0, 0], scale = [1, 1, 1]) {
  // Rz(yaw)·Ry(pitch)·Rx(roll) is three's order ZYX.
  const turn = new Quaternion().setFromEuler(new Euler(rpy[0], rpy[1], rpy[2], 'ZYX'));
  return new Matrix4().compose(new Vector3(...origin), turn, new Vector3(...scale));
}

const UP = new Vector3(0, 0, 1), Y = new Vector3(0, 1, 0);

/** From a along to b, the geometry's y axis along it. @param {number[]} a @param {number[]} b */
export function between(a, b) {
  const p = new Vector3(...a), d = new Vector3(...b).sub(p);
  const length = d.length();
  const turn = new Quaternion().setFromUnitVectors(Y, length > 1e-12 ? d.divideScalar(length) : UP);
  return { length, matrix: new Matrix4().compose(new Vector3(...a).add(new Vector3(...b)).multiplyScalar(0.5), turn, new Vector3(1, 1, 1)) };
}

/** Gathers parts with their colours into one geometry. */
export class Parts {
  constructor() {
    /** @type {{geometry: BufferGeometry, matrix: Matrix4, color: Color}[]} */
    this.list = [];
  }

  /** @param {BufferGeometry} geometry @param {Matrix4} place @param {Color} color */
  add(geometry, place, color) {
    this.list.push({ geometry: geometry.index ? geometry.toNonIndexed() : geometry, matrix: place, color });
    return this;
  }

  /** A rounded bar. */
  bar(a, b, radius, color, segments = 16) {
    const { length, matrix: place } = between(a, b);
    return this.add(length > 1e-9 ? new CapsuleGeometry(radius, length, 6, segments) : new SphereGeometry(radius, segments, 10), place, color);
  }

  /** A rod with flat ends about a middle. */
  rod(middle, axis, half, radius, color, segments = 20) {
    const a = middle.map((v, k) => v - half * axis[k]), b = middle.map((v, k) => v + half * axis[k]);
    const { length, matrix: place } = between(a, b);
    return this.add(new CylinderGeometry(radius, radius, length, segments), place, color);
  }

  ball(at, radius, color) {
    return this.add(new SphereGeometry(radius, 18, 12), matrix(at), color);
  }

  get empty() {
    return this.list.length === 0;
  }

  /** One geometry with colours per vertex in bytes. @returns {BufferGeometry|null} */
  merge() {
    let n = 0;
    for (const part of this.list) n += part.geometry.attributes.position.count;
    if (!n) return null;
    const positions = new Float32Array(3 * n), normals = new Int8Array(4 * n), colors = new Uint8Array(4 * n);
    const p = new Vector3(), m = new Matrix3();
    let at = 0;
    for (const { geometry, matrix: place, color } of this.list) {
      const { position, normal } = geometry.attributes;
      m.getNormalMatrix(place);
      const flip = place.determinant() < 0; // a mirrored mesh turns its triangles
      const rgb = [color.r, color.g, color.b].map((v) => Math.round(255 * v));
      for (let i = 0; i < position.count; i++) {
        const k = at + (flip ? i - (i % 3) + ((3 - (i % 3)) % 3) : i);
        p.fromBufferAttribute(position, i).applyMatrix4(place).toArray(positions, 3 * k);
        p.fromBufferAttribute(normal, i).applyMatrix3(m).normalize();
        normals[4 * k] = Math.round(127 * p.x); normals[4 * k + 1] = Math.round(127 * p.y); normals[4 * k + 2] = Math.round(127 * p.z);
        colors[4 * k] = rgb[0]; colors[4 * k + 1] = rgb[1]; colors[4 * k + 2] = rgb[2]; colors[4 * k + 3] = 255;
      }
      at += position.count;
    }
    const out = new BufferGeometry();
    out.setAttribute('position', new BufferAttribute(positions, 3));
    out.setAttribute('normal', new BufferAttribute(normals, 4, true));
    out.setAttribute('color', new BufferAttribute(colors, 4, true));
    out.computeBoundingBox();
    out.computeBoundingSphere();
    return out;
  }
}

/** The geometries of a visual's shape, each with the colour that its file gives it, and its own placement. @param {any} shape @param {{geometry: BufferGeometry, color: Color|null}[][]} meshes */
export function shapeGeometry(shape, meshes) {
  const one = (geometry, turn = false) => ({ parts: [{ geometry, color: null }], scale: [1, 1, 1], turn });
  if (shape.mesh) return { parts: meshes[shape.mesh.index] ?? [], scale: shape.mesh.scale ?? [1, 1, 1], turn: false };
  if (shape.box) return one(new BoxGeometry(...shape.box));
  if (shape.cylinder) return one(new CylinderGeometry(shape.cylinder[0], shape.cylinder[0], shape.cylinder[1], 32), true);
  if (shape.ellipsoid) return { ...one(new SphereGeometry(1, 28, 18)), scale: shape.ellipsoid };
  if (shape.sphere) return one(new SphereGeometry(shape.sphere, 28, 18));
  return null;
}

/** three's cylinders stand along y, the data's along z. */
export const STAND = new Matrix4().makeRotationX(Math.PI / 2);
