/** What bodies look like: a robot of one body is as large as its mesh, and frames that show nothing are no members. Usage: node --test test/shape.test.mjs */

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { BoxGeometry, Color } from 'three';
import { RobotShape, sceneSize } from '../src/robot.js';

const tree = { point: (body, point, out) => point.forEach((v, k) => { out[k] = v; }) };
const body = (name, parent, more) => ({ name, parent, origin: [0, 0, 0], rpy: [0, 0, 0], joint: { name, kind: 'fixed', axis: [0, 0, 1] }, com: [0, 0, 0], mass: 1, ...more });
const mesh = { visuals: [{ origin: [0, 0, 0.1], rpy: [0, 0, 0], color: null, shape: { mesh: { index: 0, scale: [2, 1, 1] } } }] };
const meshes = [[{ geometry: new BoxGeometry(0.4, 0.6, 0.2), color: new Color(1, 0, 0) }]];
const scene = (...bodies) => ({ bodies, elements: [], gripper: null, ground: null, root: null });

test('a robot is as large as what it shows', () => {
  const one = scene(body('hull', null, mesh));
  // The box of the mesh, twice as long, and the origin of the body on its lower face.
  assert.ok(Math.abs(sceneSize(one, meshes, tree) - Math.hypot(0.8, 0.6, 0.2)) < 1e-7);
  assert.equal(sceneSize(scene(body('point', null)), meshes, tree), 0.5);
});

test('a frame without mass shows nothing where others do', () => {
  const shapes = (...bodies) => new RobotShape(scene(...bodies), meshes, tree, () => [0, 0]).bodies;
  const [hull, frame, sensor, weight] = shapes(body('hull', null, mesh), body('frame', 0, { mass: 0 }), body('sensor', 0, { mass: 1e-4 }), body('weight', 0, { mass: 0.5 }));
  assert.ok(hull && !frame && !sensor && weight);
  // A robot that shows nothing at all is drawn of its frames.
  const [, bare] = shapes(body('arm', null), body('frame', 0, { mass: 0 }));
  assert.ok(bare);
});
