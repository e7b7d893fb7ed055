/** @file One case in 3D: bodies, elements, trail and events, solid or as a ghost. */

import { Color, Group, LessDepth, Matrix4, Mesh, MeshStandardMaterial, OctahedronGeometry, MeshBasicMaterial } from 'three';
import { Line2 } from 'three/examples/jsm/lines/Line2.js';
import { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { ElementView } from './elements.js';
import { Kinematics } from './kinematics.js';

const MOST_POINTS = 1600;
const FEWEST_POINTS = 500;

/** What all cases of one scene share. @typedef {{scene: any, tree: Kinematics, robot: import('./robot.js').RobotShape, elements: import('./elements.js').ElementShapes}} Shared */

export class CaseView {
  /** @param {import('./data.js').Case} one @param {Shared} shared @param {(name: string) => number} column */
  constructor(one, shared, column) {
    this.one = one;
    this.shared = shared;
    this.tree = new Kinematics(shared.scene, column);
    this.group = new Group();
    this.group.matrixAutoUpdate = false;
    this.ghost = false;
    this.row = 0;
    this.s = 0;
    this.solidMaterial = new MeshStandardMaterial({ vertexColors: true, roughness: 0.62, metalness: 0.06 });
    // A ghost lies behind what is solid at the same place, and shows one surface only.
    this.ghostMaterial = new MeshStandardMaterial({ roughness: 0.8, transparent: true, opacity: 0.3, depthFunc: LessDepth, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    this.tree.place(one, 0, 0);
    /** @type {{mesh: Mesh, body: number}[]} */
    this.bodies = [];
    shared.robot.bodies.forEach((geometry, i) => {
      if (geometry) this.bodies.push({ mesh: this.mesh(geometry), body: i });
    });
    if (shared.robot.root) this.mesh(shared.robot.root);
    this.elements = (shared.scene.elements ?? []).map((element, i) => new ElementView(element, shared.elements.list[i], shared.elements, this.tree, column));
    for (const element of this.elements) this.group.add(...element.meshes, ...element.contacts);
    this.grip = new Float64Array(3);
    this.trailVersion = -1;
    this.color = new Color();
    this.past = null;
    this.future = null;
    /** @type {{name: string, t: number, mesh: Mesh, at: Float64Array}[]} */
    this.marks = [];
  }

  mesh(geometry) {
    const mesh = new Mesh(geometry, this.solidMaterial);
    mesh.matrixAutoUpdate = false;
    mesh.matrixWorldAutoUpdate = false;
    mesh.matrixWorld = new Matrix4();
    mesh.castShadow = true;
    mesh.receiveShadow = true;
    this.group.add(mesh);
    return mesh;
  }

  /** @param {boolean} ghost @param {string} color @param {boolean} dark */
  look(ghost, color, dark) {
    this.ghost = ghost;
    this.color.set(color);
    this.ghostMaterial.color.set(color);
    this.ghostMaterial.opacity = dark ? 0.34 : 0.28;
    for (const mesh of /** @type {any[]} */ (this.group.children)) {
      if (mesh.material !== this.solidMaterial && mesh.material !== this.ghostMaterial) continue;
      mesh.material = ghost ? this.ghostMaterial : this.solidMaterial;
      mesh.castShadow = !ghost;
      mesh.receiveShadow = !ghost;
      mesh.renderOrder = ghost ? 1 : 0;
    }
    for (const element of this.elements) element.look(ghost);
    this.trail();
    if (this.past && this.future) {
      // Faint is nearer to the background, not seen through: short pieces of a line would show where they overlap.
      const back = new Color(dark ? '#171e28' : '#edf1f5');
      this.past.material.color.set(color).lerp(back, ghost ? 0.15 : 0);
      this.future.material.color.set(color).lerp(back, ghost ? 0.72 : 0.58);
      this.past.renderOrder = ghost ? 4 : 6; // the solid one's path lies on the others'
    }
    for (const { mesh } of this.marks) /** @type {MeshBasicMaterial} */ (mesh.material).color.set(color);
  }

  /** Has the gripper's path, or makes it anew when rows came in. */
  trail() {
    const { one, shared: { scene, robot } } = this, { gripper } = scene;
    if (!gripper || one.rows < 1 || this.trailVersion === one.version) return;
    this.trailVersion = one.version;
    const n = Math.min(Math.max(one.rows, FEWEST_POINTS), MOST_POINTS), last = one.rows - 1;
    const points = new Float32Array(3 * n), p = new Float64Array(3);
    for (let i = 0; i < n; i++) {
      const at = (last * i) / (n - 1), row = Math.min(Math.floor(at), Math.max(last - 1, 0));
      this.tree.place(one, row, last ? at - row : 0);
      this.tree.point(gripper.body ?? null, gripper.point, p);
      for (let k = 0; k < 3; k++) points[3 * i + k] = Number.isFinite(p[k]) ? p[k] : i ? points[3 * i - 3 + k] : 0;
    }
    this.trailCount = n - 1;
    for (const [name, width, order] of /** @type {const} */ ([['future', 2, 3], ['past', 3, 4]])) {
      const old = this[name];
      const geometry = new LineGeometry();
      geometry.setPositions(points);
      if (old) {
        old.geometry.dispose();
        old.geometry = geometry;
        continue;
      }
      const line = new Line2(geometry, new LineMaterial({ linewidth: width, color: this.color.getHex(), polygonOffset: true, polygonOffsetFactor: -order, polygonOffsetUnits: -4 * order }));
      line.frustumCulled = false;
      line.renderOrder = order;
      this[name] = line;
      this.group.add(line);
    }
    for (const { mesh } of this.marks) this.group.remove(mesh);
    const shape = new OctahedronGeometry(0.62 * robot.radius), material = new MeshBasicMaterial({ color: this.color });
    this.marks = one.events.slice(0, 200).map(({ name, t }) => {
      const row = one.rowAt(t);
      this.tree.place(one, row, one.between(row, t));
      const at = this.tree.point(gripper.body ?? null, gripper.point, new Float64Array(3));
      const mesh = new Mesh(shape, material);
      mesh.position.set(at[0], at[1], at[2]);
      mesh.updateMatrixWorld();
      this.group.add(mesh);
      return { name, t, mesh, at };
    });
  }

  /** Places everything at a time. @param {number} t @param {import('./range.js').Colors} colors */
  update(t, colors) {
    const { one, tree } = this;
    const row = one.rowAt(t), s = one.between(row, t);
    this.row = row;
    this.s = s;
    tree.place(one, row, s);
    for (let i = 0; i < this.bodies.length; i++) tree.matrix(this.bodies[i].body, this.bodies[i].mesh.matrixWorld.elements);
    for (let i = 0; i < this.elements.length; i++) {
      this.elements[i].move();
      this.elements[i].paint(one, row, s, colors);
    }
    const { gripper } = this.shared.scene;
    if (gripper) tree.point(gripper.body ?? null, gripper.point, this.grip);
    if (this.past) {
      const share = one.rows > 1 ? (row + s) / (one.rows - 1) : 0;
      this.past.geometry.instanceCount = Math.round(share * this.trailCount);
      this.past.visible = this.past.geometry.instanceCount > 0;
    }
  }

  /** The place of a body's joint frame, by its name. @param {string} name */
  body(name) {
    const i = this.shared.scene.bodies.findIndex((body) => body.name === name);
    return i < 0 ? null : [this.tree.pose[12 * i + 9], this.tree.pose[12 * i + 10], this.tree.pose[12 * i + 11]];
  }
}

