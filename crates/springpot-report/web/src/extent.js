/** @file How much room the motion of all cases takes, so that the camera sees it. */

import { Vector3 } from 'three';

/** Rows that are looked at. */
const SAMPLES = 24;

/**
 * @param {import('./view.js').CaseView[]} views
 * @returns {{middle: number[], radius: number, low: number, cloud: number[][]}}
 */
export function extent(views) {
  const points = [], p = new Float64Array(3), corner = new Vector3();
  for (const { one, tree, shared } of views) {
    const rows = Math.max(one.rows, 1), n = Math.min(rows, views.length > 6 ? 8 : SAMPLES);
    for (let i = 0; i < n; i++) {
      tree.place(one, Math.floor(((rows - 1) * i) / Math.max(n - 1, 1)), 0);
      shared.robot.bodies.forEach((geometry, body) => {
        if (!geometry?.boundingBox) return;
        const { min, max } = geometry.boundingBox;
        for (let c = 0; c < 8; c++) {
          corner.set(c & 1 ? max.x : min.x, c & 2 ? max.y : min.y, c & 4 ? max.z : min.z);
          tree.point(body, [corner.x, corner.y, corner.z], p);
          if (Number.isFinite(p[0] + p[1] + p[2])) points.push([p[0], p[1], p[2]]);
        }
      });
    }
    const box = shared.robot.root?.boundingBox;
    if (box) for (let c = 0; c < 8; c++) points.push([c & 1 ? box.max.x : box.min.x, c & 2 ? box.max.y : box.min.y, c & 4 ? box.max.z : box.min.z]);
    const { wanted } = shared.scene;
    if (wanted) for (let i = 0; i < wanted.x.length; i += Math.max(1, Math.floor(wanted.x.length / 40))) points.push([wanted.x[i], wanted.y[i], wanted.z[i]]);
    const { ground } = shared.scene;
    if (ground) points.push([...ground]);
  }
  if (!points.length) return { middle: [0, 0, 0], radius: 1, low: 0, cloud: [] };
  const size = Math.max(...views.map((view) => view.shared.robot.size), 1e-6);
  const centre = [0, 1, 2].map((k) => points.map((q) => q[k]).sort((a, b) => a - b)[points.length >> 1]);
  // A case that flew away does not make the others too small to see.
  const near = points.filter((q) => Math.hypot(q[0] - centre[0], q[1] - centre[1], q[2] - centre[2]) < 6 * size);
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const q of near) {
    for (let k = 0; k < 3; k++) {
      low[k] = Math.min(low[k], q[k]);
      high[k] = Math.max(high[k], q[k]);
    }
  }
  const middle = low.map((v, k) => (v + high[k]) / 2);
  const radius = Math.max(...near.map((q) => Math.hypot(q[0] - middle[0], q[1] - middle[1], q[2] - middle[2])), 0.05 * size);
  // Few points stand for all: those farthest out in many directions.
  const cloud = new Set();
  for (let i = 0; i < 120; i++) {
    const z = 1 - (2 * i + 1) / 120, f = i * 2.399963, r = Math.sqrt(1 - z * z), x = r * Math.cos(f), y = r * Math.sin(f);
    let best = near[0], most = -Infinity;
    for (const q of near) {
      const d = q[0] * x + q[1] * y + q[2] * z;
      if (d > most) { most = d; best = q; }
    }
    cloud.add(best);
  }
  return { middle, radius, low: low[2], cloud: [...cloud] };
}
