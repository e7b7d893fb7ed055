/** @file The 3D view: renderer, light, camera, viewports and what a pointer hits. */

import { Color, DirectionalLight, HemisphereLight, PCFShadowMap, PerspectiveCamera, Scene, Spherical, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { Line2 } from 'three/examples/jsm/lines/Line2.js';
import { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { Ground } from './ground.js';

/** From where the robot is first seen. */
const FROM = new Vector3(0.6, -1, 0.38).normalize();
const FIELD = 32;
/** Room left around the motion. */
const MARGIN = 1.16;
/** Shadows of many viewports cost more than they show. */
const MOST_SHADOWS = 4;

/** @typedef {{x: number, y: number, w: number, h: number}} Port in CSS pixels from the top left */

export class Stage {
  /** @param {HTMLElement} host @param {boolean} calm no damping @param {() => void} changed asks for a frame */
  constructor(host, calm, changed) {
    this.host = host;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(FIELD, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.ground = new Ground();
    this.scene.add(this.ground.group);
    this.hemisphere = new HemisphereLight('#ffffff', '#8b93a0', 1.5);
    this.hemisphere.position.set(0, 0, 1);
    this.key = new DirectionalLight('#fff6e8', 2.1);
    this.rim = new DirectionalLight('#cfe0ff', 0.7);
    this.key.shadow.mapSize.set(2048, 2048);
    this.key.shadow.radius = 4;
    this.scene.add(this.hemisphere, this.key, this.key.target, this.rim, this.rim.target);
    /** @type {import('./view.js').CaseView[]} */
    this.views = [];
    /** @type {Port[]} */
    this.ports = [];
    this.beside = false;
    /** Pixels below that the colour bar takes: of a single view the lower part, beside each other a strip. */
    this.inset = 0;
    /** 1: no shadows, 2: and fewer pixels. */
    this.thrift = 0;
    this.shaded = true;
    this.width = 1;
    this.height = 1;
    this.middle = new Vector3();
    this.radius = 1;
    /** @type {number[][]} */
    this.cloud = [];
    this.project = new Vector3();
    /** @type {WebGLRenderer|null} */
    this.renderer = null;
    /** @type {Line2[]} */
    this.wanted = [];
    try {
      this.renderer = new WebGLRenderer({ antialias: true, alpha: true, powerPreference: 'high-performance' });
    } catch {
      return; // the page says so in the robot's place
    }
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.setClearColor(0, 0);
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute('role', 'img');
    host.prepend(this.canvas);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = !calm;
    this.controls.dampingFactor = 0.12;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', changed);
    this.canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    this.canvas.addEventListener('webglcontextrestored', changed);
  }

  /** @param {number} width @param {number} height */
  resize(width, height) {
    this.width = Math.max(width, 1);
    this.height = Math.max(height, 1);
    this.renderer?.setPixelRatio(this.ratio());
    this.renderer?.setSize(this.width, this.height, true);
    this.arrange();
  }

  ratio() {
    return Math.min(window.devicePixelRatio || 1, 2) * (this.thrift > 1 ? 0.6 : 1);
  }

  /** Slow machines get less beauty while things move. @param {number} level 0, 1 or 2 */
  save(level) {
    if (level === this.thrift || !this.renderer) return;
    const coarse = this.thrift > 1 !== level > 1;
    this.thrift = level;
    this.key.castShadow = this.shaded && level < 1;
    if (coarse) {
      this.renderer.setPixelRatio(this.ratio());
      this.renderer.setSize(this.width, this.height, true);
    }
  }

  /** The views that are shown; the first one solid. @param {import('./view.js').CaseView[]} views @param {boolean} beside */
  show(views, beside) {
    for (const view of this.views) this.scene.remove(view.group);
    this.views = views;
    this.beside = beside && views.length > 1;
    for (const view of views) this.scene.add(view.group);
    this.arrange();
  }

  /** Viewports as square as can be. */
  arrange() {
    const n = this.beside ? this.views.length : 1, { width } = this, height = this.height - (this.beside ? this.inset : 0);
    let columns = 1, best = 0;
    for (let c = 1; c <= n; c++) {
      const rows = Math.ceil(n / c), side = Math.min(width / c / 1.15, height / rows);
      if (side > best * 1.02) { best = side; columns = c; }
    }
    const rows = Math.ceil(n / columns);
    this.ports = Array.from({ length: n }, (_, i) => ({
      x: Math.round((width * (i % columns)) / columns), y: Math.round((height * Math.floor(i / columns)) / rows),
      w: Math.round(width / columns), h: Math.round(height / rows),
    }));
    this.shaded = n <= MOST_SHADOWS;
    this.key.castShadow = this.shaded && this.thrift < 1;
    this.camera.aspect = this.ports[0].w / this.ports[0].h;
    this.camera.updateProjectionMatrix();
  }

  /** @param {number[]} middle @param {number} radius @param {number} floor @param {number[][]} cloud points that are to be seen */
  fit(middle, radius, floor, cloud) {
    this.cloud = cloud;
    this.middle.set(middle[0], middle[1], middle[2]);
    this.radius = radius;
    this.ground.fit(middle, radius, floor);
    const far = 3 * radius;
    this.key.position.copy(this.middle).add(new Vector3(-0.5 * far, -0.55 * far, far));
    this.key.target.position.copy(this.middle);
    this.rim.position.copy(this.middle).add(new Vector3(far, far, 0.5 * far));
    this.rim.target.position.copy(this.middle);
    const { camera } = this.key.shadow, side = 1.5 * radius;
    Object.assign(camera, { left: -side, right: side, top: side, bottom: -side, near: 0.1 * far, far: 2.6 * far });
    camera.updateProjectionMatrix();
    this.key.shadow.normalBias = 0.004 * radius;
    this.key.shadow.bias = -0.0006;
    this.camera.near = radius / 200;
    this.camera.far = radius * 60;
    this.reset();
  }

  /** The camera to where all of the motion is seen, as near as it fits. */
  reset() {
    const tall = this.ports[0]?.h ?? this.height, clear = this.beside ? 0 : this.inset, seen = Math.tan((FIELD * Math.PI) / 360);
    const v = (seen / MARGIN) * Math.max(1 - clear / tall, 0.5), h = (seen / MARGIN) * this.camera.aspect;
    const side = new Vector3(0, 0, 1).cross(FROM).normalize(), up = new Vector3().crossVectors(FROM, side), p = new Vector3();
    const target = this.middle.clone(), cloud = this.cloud.length ? this.cloud : [this.middle.toArray()];
    let away = this.radius / v;
    // What is nearer looks larger: the middle of the picture is found in a few rounds.
    for (let round = 0; round < 6; round++) {
      let left = Infinity, right = -Infinity, low = Infinity, high = -Infinity, need = 0;
      for (const q of cloud) {
        p.set(q[0], q[1], q[2]).sub(target);
        const x = p.dot(side), y = p.dot(up), z = p.dot(FROM), depth = Math.max(away - z, 1e-6);
        left = Math.min(left, x / depth); right = Math.max(right, x / depth);
        low = Math.min(low, y / depth); high = Math.max(high, y / depth);
        need = Math.max(need, Math.abs(x) / h + z, Math.abs(y) / v + z);
      }
      target.addScaledVector(side, (away * (left + right)) / 2).addScaledVector(up, (away * (low + high)) / 2);
      away = Math.max(need, 0.2 * this.radius);
    }
    // What lies at the lower edge of the view is kept clear.
    target.addScaledVector(up, -(clear / tall) * seen * away);
    this.camera.position.copy(target).addScaledVector(FROM, away);
    this.camera.updateProjectionMatrix();
    if (!this.controls) {
      this.camera.lookAt(target);
      return;
    }
    this.controls.target.copy(target);
    this.controls.minDistance = 0.05 * this.radius;
    this.controls.maxDistance = 30 * this.radius;
    this.controls.update();
  }

  /** Turns the camera about what it looks at. @param {number} side @param {number} up in radians */
  turn(side, up) {
    if (!this.controls) return;
    const offset = this.camera.position.clone().sub(this.controls.target);
    // Spherical coordinates of three stand on y.
    const s = new Spherical().setFromVector3(new Vector3(offset.x, offset.z, -offset.y));
    s.theta += side;
    s.phi = Math.min(Math.max(s.phi - up, 0.05), Math.PI - 0.05);
    const v = new Vector3().setFromSpherical(s);
    this.camera.position.copy(this.controls.target).add(new Vector3(v.x, -v.z, v.y));
    this.controls.update();
  }

  /** The paths the gripper was to follow. @param {any[]} paths */
  setWanted(paths) {
    for (const line of this.wanted) this.scene.remove(line);
    this.wanted = paths.map((path) => {
      const n = path.t?.length ?? path.x.length, points = [];
      const skip = Math.max(1, Math.floor(n / 2000));
      for (let i = 0; i < n; i += skip) if (Number.isFinite(path.x[i] + path.y[i] + path.z[i])) points.push(path.x[i], path.y[i], path.z[i]);
      if (points.length < 6) points.push(...points.slice(0, 3), ...points.slice(0, 3));
      const geometry = new LineGeometry();
      geometry.setPositions(points);
      const dash = 0.02 * this.radius;
      const line = new Line2(geometry, new LineMaterial({ linewidth: 2, dashed: true, dashSize: dash, gapSize: 0.75 * dash, color: 0, transparent: true, depthWrite: false }));
      line.computeLineDistances();
      line.frustumCulled = false;
      line.renderOrder = 3;
      this.scene.add(line);
      return line;
    });
  }

  /** @param {boolean} dark */
  look(dark) {
    this.ground.look(dark);
    this.hemisphere.intensity = dark ? 1.45 : 2.2;
    this.hemisphere.groundColor.set(dark ? '#4b5563' : '#aab2bd');
    this.key.intensity = dark ? 1.9 : 1.65;
    for (const line of this.wanted) line.material.color.set(new Color(dark ? '#f2f5f9' : '#1c242e'));
  }

  render() {
    const { renderer, ports, views } = this;
    if (!renderer) return;
    if (!this.beside) {
      renderer.setScissorTest(false);
      renderer.setViewport(0, 0, this.width, this.height);
      for (let i = 0; i < views.length; i++) views[i].group.visible = true;
      renderer.render(this.scene, this.camera);
      return;
    }
    // The strip of the colour bar is in no viewport.
    renderer.setScissorTest(false);
    renderer.clear();
    renderer.setScissorTest(true);
    for (let i = 0; i < ports.length; i++) {
      const { x, y, w, h } = ports[i], low = this.height - y - h; // the renderer counts from below
      renderer.setViewport(x, low, w, h);
      renderer.setScissor(x, low, w, h);
      for (let k = 0; k < views.length; k++) views[k].group.visible = k === i;
      renderer.render(this.scene, this.camera);
    }
  }

  /** A point in CSS pixels of a viewport; false when it is behind the camera. @param {ArrayLike<number>} p @param {number} at @param {Port} port @param {number[]} out */
  screen(p, at, port, out) {
    const v = this.project.set(p[at], p[at + 1], p[at + 2]).project(this.camera);
    out[0] = port.x + ((v.x + 1) / 2) * port.w;
    out[1] = port.y + ((1 - v.y) / 2) * port.h;
    return v.z < 1;
  }

  /** What lies under a pointer: an element or an event. @param {number} x @param {number} y */
  hit(x, y) {
    let best = null, least = Infinity;
    const a = [0, 0], b = [0, 0];
    this.ports.forEach((port, i) => {
      if (x < port.x || y < port.y || x >= port.x + port.w || y >= port.y + port.h) return;
      for (const view of this.beside ? [this.views[i]] : this.views) {
        if (!view) continue;
        for (const mark of view.marks) {
          if (!this.screen(mark.at, 0, port, a)) continue;
          const d = Math.hypot(a[0] - x, a[1] - y);
          if (d < 11 && d - 4 < least) { least = d - 4; best = { view, mark, element: null }; }
        }
        for (const element of view.elements) {
          const { line } = element;
          const point = element.shape.kind === 'spiral' || element.shape.kind === 'bushing';
          for (let k = 0; k + 3 < line.length; k += 3) {
            if (!this.screen(line, k, port, a) || !this.screen(line, point ? k : k + 3, port, b)) continue;
            const dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
            const s = square > 0 ? Math.min(Math.max(((x - a[0]) * dx + (y - a[1]) * dy) / square, 0), 1) : 0;
            const away = this.project.set(line[k], line[k + 1], line[k + 2]).distanceTo(this.camera.position);
            const thick = (element.shape.sign / (away * Math.tan((FIELD * Math.PI) / 360))) * (port.h / 2);
            const d = Math.hypot(a[0] + s * dx - x, a[1] + s * dy - y) - thick;
            // Ghosts give way to what is solid.
            const cost = d + (view.ghost ? 4 : 0);
            if (d < 9 && cost < least) { least = cost; best = { view, element, mark: null }; }
          }
        }
      }
    });
    return best;
  }
}
