/** @file What a scene's bodies look like: their visuals, or bars from joint to joint, with joints and brackets. */

import { BoxGeometry, BufferGeometry, Color, CylinderGeometry, TorusGeometry, Vector3 } from 'three';
import { Parts, STAND, matrix, meshGeometry, shapeGeometry } from './geometry.js';
import { bed, block, depth, slides } from './slide.js';

const BODY = new Color('#d9dfe7');
const BODY_FAR = new Color('#c3ccd7');
const JOINT = new Color('#454d59');
const PIVOT = new Color('#39404a');
const BASE = new Color('#7c8591');
const BRACKET = new Color('#8d96a2');

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
const ZERO = [0, 0, 0];

/** The nearest point to p on the line from the origin to an end. */
function nearest(ends, p) {
  let best = ZERO, least = distance(ZERO, p);
  for (const end of ends) {
    const square = end[0] ** 2 + end[1] ** 2 + end[2] ** 2;
    if (square < 1e-18) continue;
    const s = Math.min(Math.max((end[0] * p[0] + end[1] * p[1] + end[2] * p[2]) / square, 0), 1);
    const q = end.map((v) => s * v), d = distance(q, p);
    if (d < least) [best, least] = [q, d];
  }
  return best;
}

/** All points at which elements take hold: [body or null, point]. @param {any} scene */
function holds(scene) {
  const out = [];
  for (const { shape } of scene.elements ?? []) {
    for (const p of shape.points ?? []) out.push([p.body ?? null, p.point]);
    if (shape.bushing) for (const p of [shape.bushing.from, shape.bushing.to]) out.push([p.body ?? null, p.point, true]);
  }
  return out;
}

/** The corners of what a visual shows, in the frame of its body. @param {any} visual @param {{geometry: BufferGeometry}[][]} meshes */
function corners(visual, meshes) {
  const made = shapeGeometry(visual.shape, meshes), out = [];
  if (!made) return out;
  const place = matrix(visual.origin, visual.rpy, made.scale), corner = new Vector3();
  if (made.turn) place.multiply(STAND);
  for (const { geometry } of made.parts) {
    if (!geometry.boundingBox) geometry.computeBoundingBox();
    const { min, max } = geometry.boundingBox;
    for (let c = 0; c < 8; c++) out.push(corner.set(c & 1 ? max.x : min.x, c & 2 ? max.y : min.y, c & 4 ? max.z : min.z).applyMatrix4(place).toArray());
  }
  return out;
}

/** Of the heaviest body: what weighs less and shows nothing is a frame among bodies that show something. */
const FRAME = 0.01;

/** How long the robot's members are: sizes of signs follow from it. @param {any} scene @param {{geometry: BufferGeometry}[][]} meshes @param {import('./kinematics.js').Kinematics} tree placed */
export function sceneSize(scene, meshes, tree) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity], p = [0, 0, 0];
  const take = (body, point) => {
    tree.point(body, point, p);
    for (let k = 0; k < 3; k++) {
      if (!Number.isFinite(p[k])) continue;
      low[k] = Math.min(low[k], p[k]);
      high[k] = Math.max(high[k], p[k]);
    }
  };
  scene.bodies.forEach((body, i) => {
    take(i, ZERO);
    if (body.com) take(i, body.com);
    for (const visual of body.visuals ?? []) for (const corner of corners(visual, meshes)) take(i, corner);
  });
  if (scene.gripper) take(scene.gripper.body, scene.gripper.point);
  for (const [body, point] of holds(scene)) take(body, point);
  const size = Math.hypot(...high.map((v, k) => v - low[k]));
  return size > 1e-9 && Number.isFinite(size) ? size : 0.5;
}

/** Geometries of one scene, shared by all its cases. */
export class RobotShape {
  /**
   * @param {any} scene @param {{geometry: BufferGeometry, color: Color|null}[][]} meshes @param {import('./kinematics.js').Kinematics} tree placed at the first row
   * @param {(body: number) => number[]} range low and high of the coordinate of a body
   */
  constructor(scene, meshes, tree, range) {
    this.size = sceneSize(scene, meshes, tree);
    const bars = scene.bodies.filter((body) => !body.visuals?.length).length;
    // Many small members need thinner bars than three long ones.
    this.radius = this.size * (bars > 12 ? 0.014 : 0.019);
    const taken = holds(scene), heaviest = Math.max(0, ...scene.bodies.map((body) => body.mass ?? 0));
    this.lightest = bars < scene.bodies.length ? FRAME * heaviest : 0;
    this.slides = slides(scene, tree, this.radius, range);
    /** @type {(BufferGeometry|null)[]} */
    this.bodies = scene.bodies.map((body, i) => this.body(scene, body, i, meshes, taken.filter(([b]) => b === i)));
    this.root = this.world(scene, meshes, taken.filter(([b]) => b === null));
  }

  /** Visuals into parts. */
  visuals(parts, visuals, meshes, fallback) {
    for (const visual of visuals ?? []) {
      const made = shapeGeometry(visual.shape, meshes);
      if (!made) continue;
      const place = matrix(visual.origin, visual.rpy, made.scale);
      if (made.turn) place.multiply(STAND);
      const color = visual.color ? new Color().setRGB(visual.color[0], visual.color[1], visual.color[2], 'srgb') : fallback;
      // The file knows its parts better than the robot, which has one colour for all.
      for (const part of made.parts) parts.add(part.geometry, place, part.color ?? color);
    }
  }

  body(scene, body, i, meshes, taken) {
    const parts = new Parts(), r = this.radius, least = 0.35 * r;
    const ends = scene.bodies.filter((child) => child.parent === i).map((child) => child.origin ?? ZERO);
    if (scene.gripper?.body === i) ends.push(scene.gripper.point);
    const drawn = body.visuals?.length > 0;
    const shade = i % 2 ? BODY_FAR : BODY;
    if (drawn) this.visuals(parts, body.visuals, meshes, shade);
    else {
      const far = ends.filter((end) => distance(end, ZERO) > least);
      // Frames of sensors and tools are no members: where they are matters to those alone who put something there.
      const frame = (body.joint?.kind ?? 'fixed') === 'fixed' && (body.mass ?? 0) < this.lightest;
      for (const end of far) parts.bar(ZERO, end, frame ? 0.3 * r : r, shade);
      if (!frame && !far.length && body.com && distance(body.com, ZERO) > least) {
        ends.push(body.com);
        parts.bar(ZERO, body.com, r, shade).ball(body.com, 1.5 * r, shade);
      } else if (!frame && !far.length && !this.slides.has(i) && !depth(this.slides, scene, i)) parts.ball(ZERO, 1.35 * r, shade);
    }
    if (this.slides.has(i)) block(parts, this.slides.get(i), shade);
    else this.joint(parts, body, drawn, depth(this.slides, scene, i));
    for (const [of, slide] of this.slides) if (scene.bodies[of].parent === i) bed(parts, slide, scene.bodies[of], shade, BRACKET);
    for (const [, point, ring] of taken) {
      const from = nearest(ends, point);
      if (!ring && distance(from, point) > 0.5 * r) parts.bar(from, point, 0.3 * r, BRACKET, 10);
      if (!ring) parts.ball(point, 0.5 * r, PIVOT);
    }
    if (scene.gripper?.body === i) parts.ball(scene.gripper.point, 0.55 * r, PIVOT);
    return parts.merge();
  }

  /** A joint's axis as a dark cylinder; a guide where it slides, below the rail of another that it carries. */
  joint(parts, body, drawn, below) {
    const kind = body.joint?.kind ?? 'fixed', r = this.radius;
    if (kind === 'fixed' || kind === 'floating') return;
    const axis = body.joint.axis ?? [0, 0, 1], length = Math.hypot(...axis) || 1;
    const unit = axis.map((v) => v / length);
    // A foot stands on the ground, its axis does not reach below.
    const down = below ? [0, 0, -below - 1.25 * r] : ZERO;
    const up = body.parent == null && Math.abs(unit[2]) > 0.7 ? unit.map((v) => 1.5 * r * v * Math.sign(unit[2])) : down;
    // As round whichever way it turns.
    if (kind === 'spherical') parts.ball(up, drawn ? 0.6 * r : 1.6 * r, JOINT);
    else if (kind === 'prismatic') parts.rod(up, unit, drawn ? 1.2 * r : 1.9 * r, drawn ? 0.3 * r : 1.25 * r, JOINT, drawn ? 12 : 4);
    else if (drawn) parts.rod(up, unit, 1.5 * r, 0.3 * r, JOINT, 12);
    else {
      parts.rod(up, unit, 1.55 * r, 1.25 * r, JOINT, 28);
      parts.rod(up, unit, 1.75 * r, 0.55 * r, BODY, 20);
    }
  }

  /** What stands still: the root's visuals, feet of the robot, and anchors of the elements. */
  world(scene, meshes, taken) {
    const parts = new Parts(), r = this.radius, floor = scene.ground?.[2];
    this.visuals(parts, scene.root?.visuals, meshes, BASE);
    if (!scene.root?.visuals?.length) {
      for (const [i, body] of scene.bodies.entries()) {
        const kind = body.joint?.kind ?? 'fixed', at = body.origin ?? ZERO;
        if (body.parent != null || kind === 'floating' || kind === 'fixed' || body.visuals?.length || depth(this.slides, scene, i)) continue;
        if (this.slides.has(i)) {
          bed(parts, this.slides.get(i), body, BASE, BRACKET);
          continue;
        }
        // A guide that stands over its element needs no foot through it.
        if (kind === 'prismatic' && Math.abs(body.joint.axis?.[2] ?? 1) > 0.7) continue;
        const foot = floor !== undefined && at[2] - floor > -1e-6 && at[2] - floor < 0.6 * this.size ? floor : null;
        if (foot === null) {
          parts.add(new BoxGeometry(3 * r, 3 * r, 3 * r), matrix(at), BASE);
          continue;
        }
        const tall = 0.5 * r;
        parts.add(new CylinderGeometry(3.6 * r, 3.9 * r, tall, 40), matrix([at[0], at[1], foot + tall / 2]).multiply(STAND), BASE);
        if (at[2] - foot > 1.2 * r) parts.rod([at[0], at[1], (foot + at[2]) / 2], [0, 0, 1], (at[2] - foot) / 2, 1.5 * r, BASE, 28);
      }
    }
    for (const [, point, ring] of taken) {
      if (ring) continue;
      parts.ball(point, 0.55 * r, PIVOT);
      const above = floor === undefined ? -1 : point[2] - floor;
      if (above > 0.6 * r && above < 0.5 * this.size) parts.bar([point[0], point[1], floor], point, 0.28 * r, BRACKET, 10);
      if (above >= -1e-6 && above < 0.5 * this.size) {
        parts.add(new CylinderGeometry(1.3 * r, 1.4 * r, 0.3 * r, 24), matrix([point[0], point[1], floor + 0.15 * r]).multiply(STAND), BASE);
      } else parts.add(new TorusGeometry(0.9 * r, 0.22 * r, 8, 24), matrix(point), BASE);
    }
    return parts.merge();
  }
}

/** Decodes the page's meshes once. @param {any[]} meshes */
export const decodeMeshes = (meshes) => meshes.map((parts) => parts.map((part) => ({ geometry: meshGeometry(part), color: part.color ? new Color(part.color) : null })));
