/** @file Forward kinematics: placements of the bodies from the columns of the coordinates. */

/** Row-major 3×4 placements in one array: nine of the rotation, three of the position. */
const SIZE = 12;

/** R = Rz(yaw)·Ry(pitch)·Rx(roll). @param {number[]} rpy @param {Float64Array} out @param {number} at */
export function rotation([roll, pitch, yaw], out, at = 0) {
  const cr = Math.cos(roll), sr = Math.sin(roll), cp = Math.cos(pitch), sp = Math.sin(pitch), cy = Math.cos(yaw), sy = Math.sin(yaw);
  out[at] = cy * cp; out[at + 1] = cy * sp * sr - sy * cr; out[at + 2] = cy * sp * cr + sy * sr;
  out[at + 3] = sy * cp; out[at + 4] = sy * sp * sr + cy * cr; out[at + 5] = sy * sp * cr - cy * sr;
  out[at + 6] = -sp; out[at + 7] = cp * sr; out[at + 8] = cp * cr;
}

/** out = a·b of two placements. */
function compose(a, i, b, j, out, k) {
  for (let r = 0; r < 3; r++) {
    const x = a[i + 3 * r], y = a[i + 3 * r + 1], z = a[i + 3 * r + 2];
    out[k + 3 * r] = x * b[j] + y * b[j + 3] + z * b[j + 6];
    out[k + 3 * r + 1] = x * b[j + 1] + y * b[j + 4] + z * b[j + 7];
    out[k + 3 * r + 2] = x * b[j + 2] + y * b[j + 5] + z * b[j + 8];
    out[k + 9 + r] = x * b[j + 9] + y * b[j + 10] + z * b[j + 11] + a[i + 9 + r];
  }
}

const IDENTITY = new Float64Array([1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);

/** What moves a joint: a column, scaled and shifted, or nothing. */
function driver(bodies, joint, column, depth = 0) {
  const leader = joint.follows && depth < 16 ? bodies.find((body) => body.joint?.name === joint.follows.joint) : null;
  if (!leader) {
    // The leader of a mimic may itself be absent from the tree; its column still is the coordinate.
    const name = joint.follows ? joint.follows.joint : joint.name;
    return { column: column(`q.${name}`), ratio: joint.follows?.ratio ?? 1, offset: joint.follows?.offset ?? 0 };
  }
  const d = driver(bodies, leader.joint, column, depth + 1);
  const { ratio, offset } = joint.follows;
  return { column: d.column, ratio: ratio * d.ratio, offset: ratio * d.offset + offset };
}

/** The tree of one scene, ready to be placed. */
export class Kinematics {
  /** @param {any} scene @param {(name: string) => number} column */
  constructor(scene, column) {
    const bodies = scene.bodies ?? [];
    this.count = bodies.length;
    this.bodies = bodies;
    this.parent = Int32Array.from(bodies, (body) => body.parent ?? -1);
    this.origin = new Float64Array(SIZE * this.count);
    this.kind = bodies.map((body) => body.joint?.kind ?? 'fixed');
    this.axis = new Float64Array(3 * this.count);
    this.drivers = bodies.map((body, i) => (this.moves(i) ? driver(bodies, body.joint, column) : null));
    // A spherical joint has no position.
    this.free = bodies.map((body, i) =>
      this.kind[i] === 'floating' || this.kind[i] === 'spherical'
        ? Int32Array.from(['x', 'y', 'z', 'qx', 'qy', 'qz', 'qw'], (p) => column(`q.${body.joint.name}.${p}`)) : null);
    /** Of helical joints the shift, m/rad. */
    this.pitch = Float64Array.from(bodies, (body) => (body.joint?.lead ?? 0) / (2 * Math.PI));
    this.coordinates = new Float64Array(this.count);
    this.pose = new Float64Array(SIZE * this.count);
    this.local = new Float64Array(SIZE);
    this.middle = new Float64Array(SIZE);
    this.quaternion = new Float64Array(4);
    bodies.forEach((body, i) => {
      rotation(body.rpy ?? [0, 0, 0], this.origin, SIZE * i);
      this.origin.set(body.origin ?? [0, 0, 0], SIZE * i + 9);
      const [x, y, z] = body.joint?.axis ?? [0, 0, 1];
      const length = Math.hypot(x, y, z) || 1;
      this.axis.set([x / length, y / length, z / length], 3 * i);
    });
  }

  /** @param {number} i */
  moves(i) {
    return ['revolute', 'continuous', 'prismatic', 'helical'].includes(this.kind[i]);
  }

  /** Places all bodies of a case between a row and the next. @param {import('./data.js').Case} one @param {number} row @param {number} s */
  place(one, row, s) {
    const { local, middle, pose } = this;
    for (let i = 0; i < this.count; i++) {
      const kind = this.kind[i];
      local.set(IDENTITY);
      let q = 0;
      const d = this.drivers[i];
      if (d) {
        const value = d.column < 0 ? 0 : one.value(d.column, row, s);
        q = d.ratio * (Number.isFinite(value) ? value : 0) + d.offset;
      }
      this.coordinates[i] = q;
      const x = this.axis[3 * i], y = this.axis[3 * i + 1], z = this.axis[3 * i + 2];
      if (kind === 'revolute' || kind === 'continuous' || kind === 'helical') {
        const p = this.pitch[i] * q;
        local[9] = p * x; local[10] = p * y; local[11] = p * z;
        const c = Math.cos(q), n = Math.sin(q), v = 1 - c;
        local[0] = c + x * x * v; local[1] = x * y * v - z * n; local[2] = x * z * v + y * n;
        local[3] = y * x * v + z * n; local[4] = c + y * y * v; local[5] = y * z * v - x * n;
        local[6] = z * x * v - y * n; local[7] = z * y * v + x * n; local[8] = c + z * z * v;
      } else if (kind === 'prismatic') {
        local[9] = q * x; local[10] = q * y; local[11] = q * z;
      } else if (this.free[i]) {
        this.float(one, row, s, this.free[i]);
      }
      compose(this.origin, SIZE * i, local, 0, middle, 0);
      const parent = this.parent[i];
      if (parent < 0) pose.set(middle, SIZE * i);
      else compose(pose, SIZE * parent, middle, 0, pose, SIZE * i);
    }
    return pose;
  }

  /** Position, if it has one, and quaternion of a joint that turns freely into `local`. */
  float(one, row, s, columns) {
    const { local, quaternion: q } = this;
    for (let k = 0; k < 3; k++) {
      const value = columns[k] < 0 ? 0 : one.value(columns[k], row, s);
      local[9 + k] = Number.isFinite(value) ? value : 0;
    }
    let dot = 0;
    if (s > 0) for (let k = 0; k < 4; k++) dot += one.value(columns[3 + k], row, 0) * one.value(columns[3 + k], row + 1, 0);
    let norm = 0;
    for (let k = 0; k < 4; k++) {
      const a = one.value(columns[3 + k], row, 0);
      // Both signs are the same turn: the nearer one is taken.
      const b = s > 0 ? one.value(columns[3 + k], row + 1, 0) * (dot < 0 ? -1 : 1) : a;
      q[k] = a + s * (b - a);
      norm += q[k] * q[k];
    }
    norm = Math.sqrt(norm);
    if (!(norm > 1e-9)) return;
    const x = q[0] / norm, y = q[1] / norm, z = q[2] / norm, w = q[3] / norm;
    local[0] = 1 - 2 * (y * y + z * z); local[1] = 2 * (x * y - z * w); local[2] = 2 * (x * z + y * w);
    local[3] = 2 * (x * y + z * w); local[4] = 1 - 2 * (x * x + z * z); local[5] = 2 * (y * z - x * w);
    local[6] = 2 * (x * z - y * w); local[7] = 2 * (y * z + x * w); local[8] = 1 - 2 * (x * x + y * y);
  }

  /** A point of a body (null: the world) in world axes. @param {number|null} body @param {ArrayLike<number>} p @param {any} out @param {number} at */
  point(body, p, out, at = 0) {
    if (body == null || body < 0 || body >= this.count) {
      out[at] = p[0]; out[at + 1] = p[1]; out[at + 2] = p[2];
      return out;
    }
    const m = this.pose, i = SIZE * body;
    for (let r = 0; r < 3; r++) out[at + r] = m[i + 3 * r] * p[0] + m[i + 3 * r + 1] * p[1] + m[i + 3 * r + 2] * p[2] + m[i + 9 + r];
    return out;
  }

  /** A direction of a body in world axes. @param {number|null} body @param {ArrayLike<number>} d @param {any} out @param {number} at */
  direction(body, d, out, at = 0) {
    if (body == null || body < 0) {
      out[at] = d[0]; out[at + 1] = d[1]; out[at + 2] = d[2];
      return out;
    }
    const m = this.pose, i = SIZE * body;
    for (let r = 0; r < 3; r++) out[at + r] = m[i + 3 * r] * d[0] + m[i + 3 * r + 1] * d[1] + m[i + 3 * r + 2] * d[2];
    return out;
  }

  /** Writes a placement into a column-major 4×4. @param {number} body @param {number[]} out */
  matrix(body, out) {
    const m = this.pose, i = SIZE * body;
    out[0] = m[i]; out[1] = m[i + 3]; out[2] = m[i + 6]; out[3] = 0;
    out[4] = m[i + 1]; out[5] = m[i + 4]; out[6] = m[i + 7]; out[7] = 0;
    out[8] = m[i + 2]; out[9] = m[i + 5]; out[10] = m[i + 8]; out[11] = 0;
    out[12] = m[i + 9]; out[13] = m[i + 10]; out[14] = m[i + 11]; out[15] = 1;
  }
}
