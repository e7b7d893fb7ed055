/** @file Sliding joints with elements at them, drawn as in a textbook: a wall of what carries the joint, the elements one beside another, the body, and a rail below. */

import { BoxGeometry, Matrix4, Vector3 } from 'three';
import { matrix } from './geometry.js';
import { rails } from './signs.js';

/** Radius of an element's sign, in those of the robot's bars. */
export const SIGN = 1.1;

/** How wide a sign is. */
function width(sign, radius) {
  const n = rails(sign), one = SIGN * radius * (n === 1 ? 1 : n === 2 ? 0.72 : n === 3 ? 0.58 : 1.7 / n);
  return 2 * one + (n - 1) * 2.55 * one;
}

/**
 * A sliding joint with elements at it; directions in the frame of its body.
 * @typedef {{axis: Vector3, across: Vector3, deep: Vector3, length: number, low: number, high: number, half: number, places: Map<string, number>, radius: number}} Slide
 */

/**
 * Slides by the index of their body.
 * @param {any} scene @param {import('./kinematics.js').Kinematics} tree placed at the first row @param {number} radius of the bars
 * @param {(body: number) => number[]} range low and high of the coordinate of a body
 * @returns {Map<number, Slide>}
 */
export function slides(scene, tree, radius, range) {
  /** @type {Map<number, any[]>} */
  const found = new Map();
  for (const element of scene.elements ?? []) {
    const joint = element.shape?.joint;
    if (!joint || joint.turns || scene.bodies[joint.body]?.visuals?.length) continue;
    found.set(joint.body, [...(found.get(joint.body) ?? []), element]);
  }
  return new Map([...found].map(([body, elements]) => {
    const [low, high] = range(body), axis = new Vector3(...scene.bodies[body].joint.axis).normalize();
    const world = [0, 0, 0];
    tree.direction(body, axis.toArray(), world);
    // One above another, or from left to right where the joint stands.
    const wanted = Math.abs(world[2]) < 0.8 ? [0, 0, 1] : [1, 0, 0], columns = [0, 1, 2].map((k) => tree.direction(body, [k === 0 ? 1 : 0, k === 1 ? 1 : 0, k === 2 ? 1 : 0], [0, 0, 0]));
    const across = new Vector3(...columns.map((column) => column[0] * wanted[0] + column[1] * wanted[1] + column[2] * wanted[2]));
    across.addScaledVector(axis, -across.dot(axis)).normalize();
    const widths = elements.map((element) => width(element.sign, radius) + 0.9 * radius), all = widths.reduce((sum, w) => sum + w, 0);
    const places = new Map();
    let used = 0;
    elements.forEach((element, k) => {
      used += widths[k];
      places.set(element.name, all / 2 - used + widths[k] / 2);
    });
    return [body, { axis, across, deep: new Vector3().crossVectors(axis, across), length: 9 * radius + Math.max(-1.3 * low, 0), low, high, half: all / 2, places, radius }];
  }));
}

/** A box in the directions of a slide. @param {import('./geometry.js').Parts} parts @param {Slide} slide @param {Matrix4|null} frame */
function box(parts, slide, frame, [from, to], [below, above], deep, color) {
  const place = new Matrix4().makeBasis(slide.axis, slide.across, slide.deep);
  place.setPosition(slide.axis.clone().multiplyScalar((from + to) / 2).addScaledVector(slide.across, (below + above) / 2));
  parts.add(new BoxGeometry(to - from, above - below, deep), frame ? frame.clone().multiply(place) : place, color);
}

/** What slides: a block, in the frame of its body. @param {import('./geometry.js').Parts} parts @param {Slide} slide */
export function block(parts, slide, color) {
  const r = slide.radius;
  box(parts, slide, null, [-0.7 * r, 0.7 * r], [-slide.half - 0.3 * r, slide.half + 0.3 * r], 3 * r, color);
}

/** What it slides on: wall and rail, in the frame of the body that carries the joint. @param {import('./geometry.js').Parts} parts @param {Slide} slide @param {any} body */
export function bed(parts, slide, body, wall, rail) {
  const r = slide.radius, frame = matrix(body.origin, body.rpy), back = -slide.length, foot = -slide.half - 0.9 * r;
  box(parts, slide, frame, [back - 0.9 * r, back], [foot, slide.half + 0.6 * r], 3.6 * r, wall);
  box(parts, slide, frame, [back - 0.9 * r, Math.max(slide.high, 0) + 2.2 * r], [foot, foot + 0.5 * r], 3.6 * r, rail);
}

/** How far below a joint's frame the rail is of a slide that its body carries; 0 without. @param {Map<number, Slide>} all @param {any} scene @param {number} body */
export function depth(all, scene, body) {
  let most = 0;
  for (const [of, slide] of all) if (scene.bodies[of].parent === body) most = Math.max(most, slide.half + 0.9 * slide.radius);
  return most;
}
