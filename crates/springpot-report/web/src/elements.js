/** @file The elements of one case in 3D: they stretch, twist and take the colour of their force. */

import { BufferAttribute, BufferGeometry, DoubleSide, Matrix4, Mesh, MeshBasicMaterial, MeshDepthMaterial, MeshStandardMaterial, RGBADepthPacking } from 'three';
import { cablePiece, ring, spiral, straight } from './signs.js';
import { SIGN } from './slide.js';

/** A material whose vertices follow the length and the twist of its element. */
function follow(material, state) {
  material.onBeforeCompile = (shader) => {
    shader.uniforms.reach = state.reach;
    shader.uniforms.twist = state.twist;
    shader.vertexShader = `attribute float along;\nattribute float turn;\nuniform float reach;\nuniform float twist;\n${shader.vertexShader}`
      .replace('#include <beginnormal_vertex>', `#include <beginnormal_vertex>
        float tc = cos(turn * twist), ts = sin(turn * twist);
        objectNormal.xy = vec2(tc * objectNormal.x - ts * objectNormal.y, ts * objectNormal.x + tc * objectNormal.y);`)
      .replace('#include <begin_vertex>', `#include <begin_vertex>
        float pc = cos(turn * twist), ps = sin(turn * twist);
        transformed.xy = vec2(pc * transformed.x - ps * transformed.y, ps * transformed.x + pc * transformed.y);
        transformed.z += along * reach;`);
  };
  material.customProgramCacheKey = () => 'stretch';
  return material;
}

/** Names of the columns' prefixes of an element: its own, or those of a bushing's parts. @param {any} element */
export const parts = (element) => (element.shape?.bushing?.parts?.length ? element.shape.bushing.parts : [element.name]);

/** Geometries of a scene's elements, shared by its cases. */
export class ElementShapes {
  /** @param {any} scene @param {import('./kinematics.js').Kinematics} tree placed at the first row @param {number} radius of the bars @param {number} size @param {any[]} boxes of the bodies @param {Map<number, import('./slide.js').Slide>} slides */
  constructor(scene, tree, radius, size, boxes, slides) {
    this.radius = radius;
    const a = [0, 0, 0], b = [0, 0, 0];
    /** By body, how many elements are beside its joint already. */
    const beside = new Map();
    this.list = (scene.elements ?? []).map((element) => {
      const { points, joint, bushing } = element.shape ?? {};
      if (points?.length === 2) {
        tree.point(points[0].body ?? null, points[0].point, a);
        tree.point(points[1].body ?? null, points[1].point, b);
        const length = Math.max(Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]), 0.04 * size);
        const sign = Math.min(Math.max(0.075 * length, 0.6 * radius), 1.9 * radius);
        return { kind: 'straight', sign, geometry: straight(element.sign, length, sign) };
      }
      if (points) return { kind: 'cable', sign: 0.5 * radius, geometry: cablePiece(0.3 * radius) };
      const slide = joint && !joint.turns ? slides.get(joint.body) : null;
      if (slide) return { slide, kind: 'slide', sign: SIGN * radius, geometry: straight(element.sign, slide.length - 0.7 * radius, SIGN * radius) };
      // Beside a joint that a body's own shape would hide, as far out as that shape reaches.
      const box = joint ? boxes[joint.body] : null, k = joint ? joint.axis.reduce((best, v, i) => (Math.abs(v) > Math.abs(joint.axis[best]) ? i : best), 0) : 0;
      let off = 0, away = 0;
      if (joint) {
        tree.direction(joint.body, joint.axis, a);
        // On the side that is seen first.
        const side = 0.6 * a[0] - a[1] + 0.38 * a[2] >= 0 ? 1 : -1, reach = box ? Math.max(side > 0 ? box.max.getComponent(k) : -box.min.getComponent(k), 0) : 0;
        const wide = box ? Math.max(...[0, 1, 2].filter((c) => c !== k).map((c) => Math.min(-box.min.getComponent(c), box.max.getComponent(c)))) : 0;
        const drawn = scene.bodies[joint.body]?.visuals?.length > 0;
        off = side * Math.max(1.9 * radius, joint.turns ? Math.min(reach, 8 * radius) + 0.4 * radius : 0);
        const before = beside.get(joint.body) ?? 0;
        beside.set(joint.body, before + 1);
        away = Math.max(2.8 * radius, drawn ? Math.min(wide, 8 * radius) + 1.6 * radius : 0) + 3.4 * radius * before;
        off += side * 1.1 * radius * before;
      }
      if (joint?.turns) return { off, kind: 'spiral', sign: 3 * radius, geometry: spiral(1.6 * radius, 3.1 * radius, 0.24 * radius) };
      if (joint) return { beside: away, kind: 'slide', sign: SIGN * radius, geometry: straight(element.sign, 6 * radius, SIGN * radius) };
      if (bushing) return { kind: 'bushing', sign: 2.4 * radius, geometry: ring(2.3 * radius, 0.62 * radius), second: ring(1.25 * radius, 0.34 * radius, 0.42) };
      return { kind: 'none', sign: 0, geometry: null };
    });
    this.contact = ring(1, 0.16);
    // The ring of a contact is an ordinary mesh: what makes signs stretch is dropped.
    const plain = new BufferGeometry();
    for (const name of ['position', 'normal']) plain.setAttribute(name, /** @type {BufferAttribute} */ (this.contact.attributes[name]));
    plain.setIndex(this.contact.index);
    this.contact = plain;
  }
}

/** Writes a placement with its z axis from a to b; x stays near a reference. Returns the distance. */
function span(out, a, i, b, j, reference) {
  let zx = b[j] - a[i], zy = b[j + 1] - a[i + 1], zz = b[j + 2] - a[i + 2];
  const length = Math.hypot(zx, zy, zz);
  if (length > 1e-12) { zx /= length; zy /= length; zz /= length; } else { zx = 0; zy = 0; zz = 1; }
  let xx = reference[1] * zz - reference[2] * zy, xy = reference[2] * zx - reference[0] * zz, xz = reference[0] * zy - reference[1] * zx;
  let l = Math.hypot(xx, xy, xz);
  if (l < 1e-6) {
    // Along the reference any direction across will do.
    if (Math.abs(zx) < 0.9) { xx = 0; xy = zz; xz = -zy; } else { xx = -zz; xy = 0; xz = zx; }
    l = Math.hypot(xx, xy, xz);
  }
  xx /= l; xy /= l; xz /= l;
  out[0] = xx; out[1] = xy; out[2] = xz; out[3] = 0;
  out[4] = zy * xz - zz * xy; out[5] = zz * xx - zx * xz; out[6] = zx * xy - zy * xx; out[7] = 0;
  out[8] = zx; out[9] = zy; out[10] = zz; out[11] = 0;
  out[12] = a[i]; out[13] = a[i + 1]; out[14] = a[i + 2]; out[15] = 1;
  return length;
}

/** One element of one case. */
export class ElementView {
  /** @param {any} element @param {any} shape of ElementShapes @param {ElementShapes} shapes @param {import('./kinematics.js').Kinematics} tree placed at the first row */
  constructor(element, shape, shapes, tree, column) {
    this.element = element;
    this.shape = shape;
    this.tree = tree;
    /** @type {string} */
    this.name = element.name;
    this.forces = parts(element).map((name) => column(`${name}.force`));
    this.stores = parts(element).map((name) => column(`${name}.stored`));
    /** The line on the screen that a pointer can hit, in world axes. */
    const count = element.shape?.points?.length ?? 2;
    this.line = new Float64Array(3 * Math.max(count, 2));
    this.reference = [0, 0, 0];
    /** @type {Mesh[]} */
    this.meshes = [];
    this.states = [];
    this.entry = 0;
    this.contacts = [];
    if (shape.kind === 'none') return;
    const pieces = shape.kind === 'cable' ? Math.max(count - 1, 1) : 1;
    for (let k = 0; k < pieces; k++) this.piece(shape.geometry);
    if (shape.second) this.piece(shape.second);
    if (element.contact && shape.kind !== 'bushing') {
      const material = new MeshBasicMaterial({ color: '#f5b301' });
      for (let k = 0; k < 2; k++) {
        const mesh = new Mesh(shapes.contact, material);
        this.adopt(mesh);
        this.contacts.push(mesh);
      }
    }
    this.orient();
  }

  piece(geometry) {
    const state = { reach: { value: 1 }, twist: { value: 0 } };
    const material = follow(new MeshStandardMaterial({ vertexColors: true, roughness: 0.5, metalness: 0, side: DoubleSide }), state);
    const mesh = new Mesh(geometry, material);
    mesh.customDepthMaterial = follow(new MeshDepthMaterial({ depthPacking: RGBADepthPacking }), state);
    mesh.castShadow = true;
    this.adopt(mesh);
    this.meshes.push(mesh);
    this.states.push(state);
  }

  adopt(mesh) {
    mesh.frustumCulled = false;
    mesh.matrixAutoUpdate = false;
    mesh.matrixWorldAutoUpdate = false;
    mesh.matrixWorld = new Matrix4();
  }

  /** A direction across the element for parts that lie side by side: in the plane of a robot that moves in x and z. */
  orient() {
    this.reference[1] = 1;
    this.ends();
    if (this.shape.slide) {
      // Parts in parallel lie in the plane of the neighbours.
      this.tree.direction(this.element.shape.joint.body, this.shape.slide.deep.toArray(), this.reference);
      return;
    }
    const d = this.line, n = d.length - 3;
    const across = Math.abs(d[n + 1] - d[1]), length = Math.hypot(d[n] - d[0], d[n + 1] - d[1], d[n + 2] - d[2]);
    if (across > 0.8 * length) { this.reference[1] = 0; this.reference[2] = 1; }
  }

  /** The points of the element in world axes into `line`. */
  ends() {
    const { tree, line } = this, { points, joint, bushing } = this.element.shape;
    if (points) {
      for (let k = 0; k < points.length; k++) tree.point(points[k].body ?? null, points[k].point, line, 3 * k);
    } else if (joint) {
      const i = joint.body;
      if (joint.turns) {
        tree.point(i, ZERO, line, 0);
        tree.direction(i, joint.axis, line, 3);
        for (let k = 0; k < 3; k++) line[3 + k] += line[k];
      } else {
        // Beside the joint: from where the body is at zero to where it is, both drawn out along the axis.
        const r = this.shape.sign, q = tree.coordinates[i], { slide } = this.shape;
        if (slide) {
          // From the wall to the block, in its own place among its neighbours.
          const to = -0.7 * slide.radius, from = Math.min(-q - slide.length, to - 0.5 * slide.radius), place = slide.places.get(this.name) ?? 0;
          const { axis: a, across: c } = slide;
          SCRATCH[0] = from * a.x + place * c.x; SCRATCH[1] = from * a.y + place * c.y; SCRATCH[2] = from * a.z + place * c.z;
          tree.point(i, SCRATCH, line, 0);
          SCRATCH[0] = to * a.x + place * c.x; SCRATCH[1] = to * a.y + place * c.y; SCRATCH[2] = to * a.z + place * c.z;
          tree.point(i, SCRATCH, line, 3);
          return;
        }
        tree.direction(i, joint.axis, line, 3);
        const x = line[3], y = line[4], z = line[5];
        let sx = y, sy = -x, sz = 0;
        const l = Math.hypot(sx, sy, sz);
        if (l > 1e-6) { sx /= l; sy /= l; } else { sx = 0; sy = -1; sz = 0; }
        tree.point(i, ZERO, SCRATCH, 0);
        const far = this.shape.beside, half = 3 * r;
        line[0] = SCRATCH[0] - (q + half) * x + far * sx; line[1] = SCRATCH[1] - (q + half) * y + far * sy; line[2] = SCRATCH[2] - (q + half) * z + far * sz;
        line[3] = SCRATCH[0] + half * x + far * sx; line[4] = SCRATCH[1] + half * y + far * sy; line[5] = SCRATCH[2] + half * z + far * sz;
      }
    } else if (bushing) {
      tree.point(bushing.from.body ?? null, bushing.from.point, line, 0);
      tree.point(bushing.to.body ?? null, bushing.to.point, line, 3);
    }
  }

  /** Moves the element to the placed bodies. */
  move() {
    const { line, meshes, states, shape } = this;
    if (!meshes.length) return;
    this.ends();
    if (shape.kind === 'bushing') {
      this.seat(meshes[0].matrixWorld.elements, this.element.shape.bushing.from, 0);
      this.seat(meshes[1].matrixWorld.elements, this.element.shape.bushing.to, 3);
      return;
    }
    if (shape.kind === 'spiral') {
      span(meshes[0].matrixWorld.elements, line, 0, line, 3, this.reference);
      // The frame turns with the body, so that the inner end does.
      const { body } = this.element.shape.joint, q = this.tree.coordinates[body];
      states[0].twist.value = -Math.max(-9, Math.min(9, q));
      this.tree.matrix(body, FRAME);
      turnInto(meshes[0].matrixWorld.elements, this.element.shape.joint.axis);
      const e = meshes[0].matrixWorld.elements, off = shape.off;
      e[12] += off * e[8]; e[13] += off * e[9]; e[14] += off * e[10];
      return;
    }
    for (let k = 0; k < meshes.length; k++) {
      states[k].reach.value = span(meshes[k].matrixWorld.elements, line, 3 * k, line, 3 * k + 3, this.reference);
    }
  }

  /** A ring in the axes of its body. */
  seat(out, end, at) {
    const i = end.body ?? null;
    if (i === null) for (let k = 0; k < 16; k++) out[k] = k % 5 === 0 ? 1 : 0;
    else this.tree.matrix(i, out);
    out[12] = this.line[at]; out[13] = this.line[at + 1]; out[14] = this.line[at + 2];
  }

  /** The largest force of its parts relative to the range, and its energy; sets the colour. */
  paint(one, row, s, colors) {
    this.entry = colors.entry(this, one, row, s);
    const table = colors.map.linear, i = 3 * this.entry;
    for (let k = 0; k < this.meshes.length; k++) {
      const { color, emissive } = /** @type {MeshStandardMaterial} */ (this.meshes[k].material);
      color.r = table[i]; color.g = table[i + 1]; color.b = table[i + 2];
      // A little light of its own keeps the colour true in the shade.
      emissive.r = 0.06 * table[i]; emissive.g = 0.06 * table[i + 1]; emissive.b = 0.06 * table[i + 2];
    }
    if (!this.contacts.length) return;
    const force = one.value(this.forces[0], row, s), touches = Math.abs(force) > 1e-12, n = this.line.length - 3;
    for (let k = 0; k < 2; k++) {
      const mesh = this.contacts[k], out = mesh.matrixWorld.elements;
      mesh.visible = touches;
      if (!touches) continue;
      const scale = this.shape.kind === 'cable' ? 2.6 * this.shape.sign : 0.9 * this.shape.sign;
      span(out, this.line, k ? n - 3 : 0, this.line, k ? n : 3, this.reference);
      const at = k ? n : 0;
      for (let c = 0; c < 12; c++) if (c % 4 !== 3) out[c] *= scale;
      out[12] = this.line[at]; out[13] = this.line[at + 1]; out[14] = this.line[at + 2];
    }
  }

  /** A ghost's element is seen through. @param {boolean} ghost */
  look(ghost) {
    this.meshes.forEach((mesh) => {
      const material = /** @type {MeshStandardMaterial} */ (mesh.material);
      material.transparent = ghost;
      material.opacity = ghost ? 0.55 : 1;
      material.polygonOffset = ghost;
      material.polygonOffsetFactor = 1;
      material.polygonOffsetUnits = 1;
      mesh.castShadow = !ghost;
      mesh.renderOrder = ghost ? 2 : 0;
      material.needsUpdate = true;
    });
  }
}

const ZERO = [0, 0, 0];
const SCRATCH = new Float64Array(3);
const FRAME = new Array(16).fill(0);

/** Turns the columns x and y of a placement to a direction fixed in the body of FRAME, z being its axis. */
function turnInto(out, axis) {
  // Any direction of the body across the axis, taken into world axes.
  const k = Math.abs(axis[0]) < 0.6 ? 0 : 1;
  let x = FRAME[4 * k], y = FRAME[4 * k + 1], z = FRAME[4 * k + 2];
  const d = x * out[8] + y * out[9] + z * out[10];
  x -= d * out[8]; y -= d * out[9]; z -= d * out[10];
  const l = Math.hypot(x, y, z) || 1;
  out[0] = x / l; out[1] = y / l; out[2] = z / l;
  out[4] = out[9] * out[2] - out[10] * out[1]; out[5] = out[10] * out[0] - out[8] * out[2]; out[6] = out[8] * out[1] - out[9] * out[0];
}
