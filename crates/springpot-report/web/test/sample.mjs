/** Pages from made-up data: the tests run on them where no real ones are at hand. Usage: node test/sample.mjs FOLDER */

import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const PAGE = fileURLToPath(new URL('../../assets/viewer.html', import.meta.url));

/** @param {ArrayBufferView} list */
const base64 = (list) => Buffer.from(list.buffer, list.byteOffset, list.byteLength).toString('base64');

/** Data as it stands in the page: no tag can end the script. */
export const page = (data) => readFileSync(PAGE, 'utf8').replace('@DATA@', () => JSON.stringify(data).replace(/</g, '\\u003c'));

/** Writes NAME.html and NAME/results.csv. Cases have `table`: rows of numbers. */
function write(folder, name, data) {
  const lines = [data.columns.map((column) => column.name).join(',')];
  const cases = data.cases.map(({ table, ...one }) => {
    for (const row of table) lines.push(row.map((v) => (Number.isFinite(v) ? String(v) : '')).join(','));
    const packed = new Float32Array(table.length * data.columns.length);
    table.forEach((row, r) => row.forEach((v, c) => { packed[c * table.length + r] = v; }));
    return { rows: table.length, data: base64(packed), ...one };
  });
  mkdirSync(join(folder, name), { recursive: true });
  writeFileSync(join(folder, name, 'results.csv'), `${lines.join('\n')}\n`);
  writeFileSync(join(folder, `${name}.html`), page({ version: '0.1.0', name, notes: [], meshes: [], follow: null, status: 'done', ...data, cases }));
}

// 4×4 matrices as nested lists: slow, plain, and not the viewer's own code.
const identity = () => [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]];
const times = (a, b) => a.map((row) => [0, 1, 2, 3].map((c) => row.reduce((sum, v, k) => sum + v * b[k][c], 0)));
const shift = ([x, y, z]) => [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]];
const turns = {
  x: (q) => [[1, 0, 0, 0], [0, Math.cos(q), -Math.sin(q), 0], [0, Math.sin(q), Math.cos(q), 0], [0, 0, 0, 1]],
  y: (q) => [[Math.cos(q), 0, Math.sin(q), 0], [0, 1, 0, 0], [-Math.sin(q), 0, Math.cos(q), 0], [0, 0, 0, 1]],
  z: (q) => [[Math.cos(q), -Math.sin(q), 0, 0], [Math.sin(q), Math.cos(q), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
};
const place = (m, p) => m.slice(0, 3).map((row) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]);
const axisName = (axis) => 'xyz'[axis.findIndex((v) => Math.abs(v) > 0.5)];
const fromQuaternion = ([x, y, z, w]) => [
  [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0], [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0],
  [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0], [0, 0, 0, 1]];

/** Placements of all bodies; q: value or [position, quaternion] by joint. */
function placed(bodies, q) {
  const out = [];
  for (const { parent, origin, rpy, joint } of bodies) {
    let m = times(shift(origin), times(turns.z(rpy[2]), times(turns.y(rpy[1]), turns.x(rpy[0]))));
    const value = joint.follows ? joint.follows.ratio * q[joint.follows.joint] + joint.follows.offset : q[joint.name];
    if (joint.kind === 'floating') m = times(m, times(shift(value[0]), fromQuaternion(value[1])));
    else if (joint.kind === 'prismatic') m = times(m, shift(joint.axis.map((v) => v * value)));
    else if (joint.kind !== 'fixed') m = times(m, turns[axisName(joint.axis)]((Math.sign(joint.axis.find((v) => v)) || 1) * value));
    out.push(parent === null ? times(identity(), m) : times(out[parent], m));
  }
  return out;
}

const body = (name, parent, origin, kind, axis, more = {}) => ({ name, parent, origin, rpy: [0, 0, 0], joint: { name: `q_${name}`, kind, axis, follows: null }, com: [0, 0, 0.1], mass: 1, visuals: [], ...more });
const unit = (name) => (/^q\./.test(name) ? 'rad' : /length|stroke|gripper/.test(name) ? 'm' : /force/.test(name) ? 'N' : /stored|dissipated|energy/.test(name) ? 'J' : /rate/.test(name) ? 'm/s' : name === 't' ? 's' : '');
const columns = (names) => names.map((name) => ({ name, unit: unit(name), meaning: name === 't' ? 'time' : `${name.split('.').pop()} of ${name.split('.')[0]}` }));
const ends = (shape, m) => shape.points.map(({ body: b, point }) => (b === null ? point : place(m[b], point)));
const far = (a, b) => Math.hypot(...a.map((v, k) => b[k] - v));

/** An arm with a strut, a tendon, a damped joint and a stop, in some cases. */
function arm(count, options = {}) {
  const tag = options.tag ?? ((text) => text);
  const bodies = [
    body(tag('column'), null, [0, 0, 0], 'revolute', [0, 0, 1], { com: [0, 0, 0.3] }),
    body(tag('upper arm'), 0, [0, 0, 0.5], 'revolute', [0, 1, 0], { com: [0.2, 0, 0] }),
    body(tag('forearm'), 1, [0.45, 0, 0.06], 'revolute', [0, 1, 0], { com: [0.2, 0, 0] }),
    body(tag('slide'), 2, [0.36, 0, 0], 'prismatic', [1, 0, 0], { com: [0.05, 0, 0] }),
  ];
  const [strut, tendon, coupling, stop] = ['strut', 'tendon', 'coupling', 'stop'].map(tag);
  const elements = [
    { name: strut, contact: false, sign: { parallel: ['spring', 'springpot', { series: ['dashpot', 'spring'] }] }, shape: { points: [{ body: 0, point: [0.14, 0, 0.08] }, { body: 2, point: [-0.06, 0, 0.1] }] } },
    { name: tendon, contact: true, sign: 'spring', shape: { points: [{ body: 0, point: [-0.1, 0, 0.3] }, { body: 1, point: [0.05, 0, 0.12] }, { body: 2, point: [0.12, 0, 0.06] }] } },
    { name: coupling, contact: false, sign: 'springpot', shape: { joint: { body: 1, axis: [0, 1, 0], turns: true } } },
    { name: stop, contact: true, sign: { parallel: ['spring', 'dashpot'] }, shape: { points: [{ body: null, point: [0.82, 0, 0.02] }, { body: 3, point: [0.04, 0, -0.05] }] } },
  ];
  const gripper = { body: 3, point: [0.1, 0, 0] };
  const names = ['t', ...bodies.map(({ joint }) => `q.${joint.name}`), ...elements.flatMap(({ name }) => ['length', 'stroke', 'rate', 'force', 'stored', 'dissipated'].map((c) => `${name}.${c}`)), 'gripper.x', 'gripper.y', 'gripper.z', 'gripper.error', 'energy.kinetic', 'energy.potential', 'energy.residual'];
  const rows = options.rows ?? 601, end = 6, wanted = { t: [], x: [], y: [], z: [] };
  const cases = Array.from({ length: count }, (_, c) => {
    const alpha = 0.2 + (0.6 * c) / Math.max(count - 1, 1), table = [], lost = elements.map(() => 0);
    let before = null;
    const own = options.failed === c ? Math.floor(rows * 0.55) : rows;
    for (let r = 0; r < own; r++) {
      const t = (end * r) / (rows - 1), fade = Math.exp(-(0.15 + 0.5 * alpha) * t);
      const motion = (f) => [0.5 * Math.sin(0.5 * t), -0.5 + 0.25 * Math.sin(2 * t) + f * 0.22 * Math.cos(7 * t), 0.9 - 0.3 * Math.sin(1.3 * t) + f * 0.3 * Math.sin(6 * t), 0.03 * Math.sin(3 * t)];
      const q = motion(fade), map = Object.fromEntries(bodies.map(({ joint }, i) => [joint.name, q[i]])), m = placed(bodies, map);
      const grip = place(m[3], gripper.point), ideal = place(placed(bodies, Object.fromEntries(bodies.map(({ joint }, i) => [joint.name, motion(0)[i]])))[3], gripper.point);
      if (c === 0) { wanted.t.push(t); wanted.x.push(ideal[0]); wanted.y.push(ideal[1]); wanted.z.push(ideal[2]); }
      const lengths = elements.map(({ shape }) => (shape.points ? ends(shape, m).reduce((sum, p, k, all) => (k ? sum + far(all[k - 1], p) : 0), 0) : q[1]));
      before ??= lengths;
      const dt = end / (rows - 1);
      const values = elements.flatMap((element, e) => {
        const rest = [0.66, 0.62, -0.5, 0.3][e], x = lengths[e] - rest, rate = (lengths[e] - before[e]) / dt, k = [180, 60, 9, 900][e], d = [30, 4, 1.2, 25][e] * (0.4 + alpha);
        let force = k * x + d * rate;
        if (element.contact) force = e === 1 ? Math.max(force, 0) : Math.min(force, 0);
        lost[e] += Math.abs(d * rate * rate) * dt;
        return [lengths[e], x, rate, force, 0.5 * k * x * x * (force ? 1 : 0), lost[e]];
      });
      before = lengths;
      table.push([t, ...q, ...values, ...grip, far(grip, ideal), 2 * fade, 40 + fade, options.gap && r > 200 && r < 240 ? NaN : 1e-9 * Math.sin(20 * t) * t]);
    }
    const failed = options.failed === c;
    return {
      index: c, name: count > 1 ? `${tag('α')} = ${alpha.toFixed(2)}` : '', parameters: { [`element.${strut}.alpha`]: alpha }, scene: 0, status: failed ? 'failed' : 'done', table,
      error: failed ? 'no step is small enough at t = 3.3 s: the force of element "stop" grows beyond 1e12 N; a damper in parallel would limit it' : null,
      events: failed ? [] : [{ name: tag('touch'), t: 1.1 + 0.1 * c }, { name: tag('let go'), t: 2.45 }, { name: tag('arrived'), t: 5.2 }],
      metrics: [{ name: 'overshoot', column: 'gripper.error', value: 0.031 + 0.01 * c, unit: 'm' }, { name: 'settling time', column: 'gripper.error', value: 3.2 - c * 0.3, unit: 's' }, { name: 'rms', column: `${strut}.force`, value: 21.4, unit: 'N' }],
    };
  });
  const law = (name, kind, equation, parameters) => ({ name, law: kind, equation, source: null, parameters });
  const cols = columns(names);
  for (const column of cols) if (column.name === `${coupling}.force`) column.unit = 'N*m';
  for (const column of cols) if (column.name === `q.${bodies[3].joint.name}`) column.unit = 'm';
  return {
    title: options.title ?? 'Three-body arm with a strut, a tendon and a stop', columns: cols, notes: options.notes ?? ['every 2nd of 1201 rows is shown'],
    scenes: [{ bodies, root: null, ground: [0, 0, 0], gripper, elements, wanted }],
    elements: [
      law(strut, 'thermoviscoelastic', 'F = (E_c + E_kv)·x + E_d·D^alpha x − a_kv·E_kv·(T − T_ref)', [{ name: 'E_c', value: 120, unit: 'N/m' }, { name: 'E_kv', value: 60, unit: 'N/m' }, { name: 'E_d', value: 30, unit: 'N*s^alpha/m' }, { name: 'alpha', value: 0.5, unit: '1' }, { name: 'a_kv', value: 0.0007, unit: 'm/K' }, { name: 'T_ref', value: 293.15, unit: 'K' }]),
      law(tendon, 'one-sided spring', 'F = k·x for x > 0', [{ name: 'k', value: 60, unit: 'N/m' }]),
      law(coupling, 'springpot', 'F = c·D^alpha x', [{ name: 'c', value: 9, unit: 'N*m*s^alpha' }, { name: 'alpha', value: 0.4, unit: '1' }]),
      law(stop, 'kelvin-voigt', "F = k·x + c·x'", [{ name: 'k', value: 900, unit: 'N/m' }, { name: 'c', value: 25, unit: 'N*s/m' }]),
    ],
    cases,
  };
}

/** A walking figure of 35 bodies that floats, with 12 elements and 220 columns. */
function humanoid() {
  const bodies = [], add = (...args) => bodies.push(body(...args)) - 1;
  const pelvis = add('pelvis', null, [0, 0, 0], 'floating', [0, 0, 1]);
  const joints = (names, parent) => names.reduce((p, [name, origin, axis, com]) => add(name, p, origin, 'revolute', axis, com ? { com } : {}), parent);
  const waist = joints([['waist yaw', [0, 0, 0.08], [0, 0, 1]], ['waist roll', [0, 0, 0.05], [1, 0, 0]], ['torso', [0, 0, 0.08], [0, 1, 0], [0, 0, 0.2]]], pelvis);
  joints([['neck', [0, 0, 0.36], [0, 0, 1]], ['head', [0, 0, 0.07], [0, 1, 0], [0, 0, 0.13]]], waist);
  const tips = {};
  for (const [side, s] of [['left', 1], ['right', -1]]) {
    const arm = joints([[`${side} shoulder pitch`, [0, 0.17 * s, 0.3], [0, 1, 0]], [`${side} shoulder roll`, [0, 0.05 * s, 0], [1, 0, 0]], [`${side} shoulder yaw`, [0, 0.02 * s, -0.1], [0, 0, 1]], [`${side} elbow`, [0, 0, -0.18], [0, 1, 0]], [`${side} wrist yaw`, [0.02, 0, -0.13], [0, 0, 1]], [`${side} wrist`, [0, 0, -0.12], [0, 1, 0], [0, 0, -0.09]]], waist);
    for (const [finger, y] of [['thumb', 0.03], ['finger', -0.03]]) add(`${side} ${finger}`, arm, [0, y, -0.08], finger === 'thumb' ? 'fixed' : 'revolute', [0, 1, 0], { com: [0, 0, -0.06] });
    const leg = joints([[`${side} hip yaw`, [0, 0.1 * s, -0.04], [0, 0, 1]], [`${side} hip roll`, [0, 0, -0.04], [1, 0, 0]], [`${side} hip`, [0, 0, -0.03], [0, 1, 0]], [`${side} knee`, [0, 0, -0.4], [0, 1, 0]], [`${side} ankle`, [0, 0, -0.38], [0, 1, 0]], [`${side} foot`, [0, 0, -0.04], [1, 0, 0], [0.08, 0, -0.03]]], leg0(pelvis));
    tips[side] = { arm, leg };
  }
  function leg0(p) { return p; }
  add('toe', tips.left.leg, [0.14, 0, -0.03], 'fixed', [0, 1, 0], { com: [0.05, 0, 0] });
  const at = (name) => bodies.findIndex((b) => b.name === name);
  const line = (name, sign, a, pa, b, pb, contact = false) => ({ name, sign, contact, shape: { points: [{ body: a === null ? null : at(a), point: pa }, { body: at(b), point: pb }] } });
  const kv = { parallel: ['spring', 'dashpot'] }, elements = [];
  for (const [side, s] of [['left', 1], ['right', -1]]) {
    elements.push(line(`${side} thigh`, kv, `${side} hip`, [0.07, 0, -0.05], `${side} knee`, [0.07, 0, -0.12]), line(`${side} calf`, 'springpot', `${side} knee`, [-0.07, 0, -0.06], `${side} foot`, [-0.08, 0, -0.02]));
    elements.push(line(`${side} biceps`, 'spring', `${side} shoulder yaw`, [0.05, 0, -0.02], `${side} elbow`, [0.05, 0, -0.09]), line(`${side} back`, { series: ['dashpot', 'spring'] }, 'pelvis', [-0.1, 0.08 * s, 0], 'torso', [-0.1, 0.12 * s, 0.24]));
    elements.push({ name: `${side} tendon`, sign: 'spring', contact: true, shape: { points: [{ body: at(`${side} elbow`), point: [-0.03, 0, -0.02] }, { body: at(`${side} wrist`), point: [-0.03, 0, -0.02] }, { body: at(`${side} finger`), point: [-0.02, 0, -0.03] }] } });
    elements.push({ name: `${side} ankle pad`, sign: 'springpot', contact: false, shape: { joint: { body: at(`${side} ankle`), axis: [0, 1, 0], turns: true } } });
  }
  const moving = bodies.filter(({ joint }) => joint.kind === 'revolute');
  const names = ['t', ...['x', 'y', 'z', 'qx', 'qy', 'qz', 'qw'].map((p) => `q.q_pelvis.${p}`), ...moving.map(({ joint }) => `q.${joint.name}`), ...moving.map(({ joint }) => `v.${joint.name}`), ...moving.map(({ joint }) => `tau.${joint.name}`), ...elements.flatMap(({ name }) => ['length', 'stroke', 'rate', 'force', 'stored', 'dissipated'].map((c) => `${name}.${c}`)), 'gripper.x', 'gripper.y', 'gripper.z', 'energy.residual'];
  while (names.length < 220) names.push(`sensor.${names.length}`);
  const gripper = { body: at('right wrist'), point: [0, 0, -0.1] }, rows = 1000, end = 10, table = [], lost = elements.map(() => 0);
  let before = null, old = null;
  for (let r = 0; r < rows; r++) {
    const t = (end * r) / (rows - 1), w = 2 * Math.PI * 0.8 * t, dt = end / (rows - 1);
    const angle = (name) => {
      const s = name.startsWith('left') ? 1 : -1, f = s * Math.sin(w);
      if (/hip$/.test(name)) return -0.25 + 0.4 * f;
      if (/knee/.test(name)) return 0.45 + 0.4 * s * Math.cos(w);
      if (/ankle$/.test(name)) return -0.2 - 0.2 * s * Math.cos(w + 0.4);
      if (/shoulder pitch/.test(name)) return -0.5 * f;
      if (/shoulder roll/.test(name)) return 0.14 * s;
      if (/elbow/.test(name)) return -0.8 - 0.3 * f;
      if (/finger/.test(name)) return 0.4 + 0.3 * Math.sin(3 * w);
      if (/waist yaw/.test(name)) return 0.12 * Math.sin(w);
      return 0.05 * Math.sin(w + name.length);
    };
    const yaw = 0.35 * Math.sin(0.3 * t), q = { q_pelvis: [[0.25 * t - 1.2, 0.2 * Math.sin(0.3 * t), 0.93 + 0.02 * Math.cos(2 * w)], [0, 0, Math.sin(yaw / 2), Math.cos(yaw / 2)]] };
    for (const b of moving) q[b.joint.name] = angle(b.name);
    for (const b of bodies) q[b.joint.name] ??= 0;
    const m = placed(bodies, q), lengths = elements.map(({ shape }) => (shape.points ? ends(shape, m).reduce((sum, p, k, all) => (k ? sum + far(all[k - 1], p) : 0), 0) : q[bodies[shape.joint.body].joint.name]));
    before ??= lengths;
    const rests = (old ??= lengths), angles = moving.map((b) => q[b.joint.name]);
    const values = elements.flatMap(({ contact }, e) => {
      const x = lengths[e] - rests[e], rate = (lengths[e] - before[e]) / dt, k = elements[e].shape.joint ? 40 : 800;
      const force = contact ? Math.max(k * x, 0) : k * x + 12 * rate;
      lost[e] += 12 * rate * rate * dt;
      return [lengths[e], x, rate, force, 0.5 * k * x * x, lost[e]];
    });
    before = lengths;
    const row = [t, ...q.q_pelvis[0], ...q.q_pelvis[1], ...angles, ...angles.map((v) => 3 * v), ...angles.map((v) => 20 * v), ...values, ...place(m[gripper.body], gripper.point), 1e-10 * t];
    while (row.length < names.length) row.push(Math.sin(row.length + t));
    table.push(row);
  }
  const cols = columns(names);
  for (const column of cols) if (/ankle pad\.force/.test(column.name)) column.unit = 'N*m';
  return {
    title: 'Walking humanoid with elastic muscles', columns: cols, notes: [],
    scenes: [{ bodies, root: null, ground: [0, 0, 0], gripper, elements, wanted: null }],
    elements: elements.map(({ name }) => ({ name, law: 'kelvin-voigt', equation: "F = k·x + c·x'", source: null, parameters: [{ name: 'k', value: 800, unit: 'N/m' }, { name: 'c', value: 12, unit: 'N*s/m' }] })),
    cases: [{ index: 0, name: '', parameters: {}, status: 'done', error: null, scene: 0, table, events: [{ name: 'step', t: 1.25 }, { name: 'step', t: 2.5 }], metrics: [] }],
  };
}

/** A round housing as a mesh of quantised vertices, as files of meshes come. */
function housing() {
  const positions = [], triangles = [], n = 40, profile = [[0, 0], [0.5, 0], [0.5, 0.25], [0.36, 0.32], [0.36, 0.85], [0.46, 0.92], [0.46, 1], [0, 1]];
  for (const [r, z] of profile) for (let i = 0; i < n; i++) positions.push(0.5 + r * Math.cos((2 * Math.PI * i) / n), 0.5 + r * Math.sin((2 * Math.PI * i) / n), z);
  for (let k = 0; k + 1 < profile.length; k++) for (let i = 0; i < n; i++) {
    const a = k * n + i, b = k * n + ((i + 1) % n);
    triangles.push(a, b, a + n, b, b + n, a + n);
  }
  return { low: [-0.08, -0.08, 0], size: [0.16, 0.16, 0.4], positions: base64(Uint16Array.from(positions, (v) => Math.round(65535 * v))), triangles: base64(Uint32Array.from(triangles)) };
}

/** Visuals of all kinds, a mimic finger, a bushing, a slide with an element. */
function visuals() {
  const mesh = (color, origin = [0, 0, 0], rpy = [0, 0, 0], scale = [1, 1, 1]) => ({ origin, rpy, color, shape: { mesh: { index: 0, scale } } });
  const bodies = [
    body('shoulder', null, [0, 0, 0.12], 'revolute', [0, 0, 1], { visuals: [mesh([0.92, 0.93, 0.95, 1])] }),
    body('boom', 0, [0, 0, 0.4], 'revolute', [0, 1, 0], { visuals: [mesh([0.95, 0.62, 0.12, 1], [0, 0, 0], [0, Math.PI / 2, 0], [0.8, 0.8, 1.25]), { origin: [0, 0, 0], rpy: [Math.PI / 2, 0, 0], color: [0.2, 0.22, 0.26, 1], shape: { cylinder: [0.085, 0.19] } }] }),
    body('carriage', 1, [0.5, 0, 0], 'prismatic', [1, 0, 0], { visuals: [{ origin: [0.06, 0, 0], rpy: [0, 0, 0], color: [0.25, 0.3, 0.36, 1], shape: { box: [0.14, 0.1, 0.1] } }] }),
    body('left finger', 2, [0.13, 0.03, 0], 'prismatic', [0, 1, 0], { visuals: [{ origin: [0.04, 0, 0], rpy: [0, 0, 0], color: null, shape: { box: [0.08, 0.018, 0.03] } }] }),
    body('right finger', 2, [0.13, -0.03, 0], 'prismatic', [0, -1, 0], { visuals: [{ origin: [0.04, 0, 0], rpy: [0, 0, 0], color: null, shape: { box: [0.08, 0.018, 0.03] } }] }),
    body('tool', 2, [0.06, 0, -0.12], 'floating', [0, 0, 1], { visuals: [{ origin: [0, 0, 0], rpy: [0, 0, 0], color: [0.5, 0.55, 0.62, 1], shape: { sphere: 0.045 } }] }),
  ];
  bodies[4].joint.follows = { joint: 'q_left finger', ratio: 1, offset: 0 };
  const elements = [
    { name: 'linear drive', sign: { parallel: ['spring', 'dashpot'] }, contact: false, shape: { joint: { body: 2, axis: [1, 0, 0], turns: false } } },
    { name: 'mount', sign: 'springpot', contact: false, shape: { bushing: { from: { body: 2, point: [0.06, 0, -0.08], rpy: [0, 0, 0] }, to: { body: 5, point: [0, 0, 0.04], rpy: [0, 0, 0] }, parts: ['mount.x', 'mount.z'] } } },
  ];
  const names = ['t', 'q.q_shoulder', 'q.q_boom', 'q.q_carriage', 'q.q_left finger', ...['x', 'y', 'z', 'qx', 'qy', 'qz', 'qw'].map((p) => `q.q_tool.${p}`), ...['linear drive', 'mount.x', 'mount.z'].flatMap((n) => [`${n}.stroke`, `${n}.force`, `${n}.stored`]), 'gripper.x', 'gripper.y', 'gripper.z'];
  const gripper = { body: 2, point: [0.2, 0, 0] }, table = [];
  for (let r = 0; r <= 300; r++) {
    const t = r / 200, sway = 0.3 * Math.sin(9 * t), s = 0.06 * Math.sin(5 * t), x = 0.012 * Math.sin(9 * t), z = 0.01 * Math.cos(9 * t);
    const q = { q_shoulder: 0.8 * Math.sin(2 * t), q_boom: -0.2 + 0.3 * Math.sin(3 * t), q_carriage: s, 'q_left finger': 0.01 + 0.01 * Math.sin(6 * t), 'q_right finger': 0, q_tool: [[x, 0, z], [0, Math.sin(sway / 2), 0, Math.cos(sway / 2)]] };
    const m = placed(bodies, q);
    table.push([t, q.q_shoulder, q.q_boom, s, q['q_left finger'], x, 0, z, ...q.q_tool[1], s, 400 * s, 200 * s * s, x, 900 * x, 450 * x * x, z, 900 * z, 450 * z * z, ...place(m[2], gripper.point)]);
  }
  const law = (name, kind) => ({ name, law: kind, equation: 'F = k·x + c·D^alpha x', source: 'data sheet', parameters: [{ name: 'k', value: 900, unit: 'N/m' }] });
  return {
    title: null, columns: columns(names), meshes: [[housing()]],
    scenes: [{ bodies, root: { name: 'base', visuals: [{ origin: [0, 0, 0.06], rpy: [0, 0, 0], color: [0.3, 0.33, 0.38, 1], shape: { cylinder: [0.12, 0.12] } }] }, ground: [0, 0, 0], gripper, elements, wanted: null }],
    elements: [law('linear drive', 'kelvin-voigt'), law('mount.x', 'fractional-kelvin-voigt'), law('mount.z', 'fractional-kelvin-voigt')],
    cases: [{ index: 0, name: '', parameters: {}, status: 'done', error: null, scene: 0, table, events: [], metrics: [] }],
  };
}

/** A free body that tumbles, without ground or elements. */
function floating() {
  const bodies = [body('box', null, [0, 0, 0], 'floating', [0, 0, 1], { visuals: [{ origin: [0, 0, 0], rpy: [0, 0, 0], color: null, shape: { box: [0.3, 0.2, 0.1] } }] })];
  const names = ['t', ...['x', 'y', 'z', 'qx', 'qy', 'qz', 'qw'].map((p) => `q.q_box.${p}`), 'gripper.x', 'gripper.y', 'gripper.z', 'energy.residual'], table = [];
  for (let r = 0; r <= 120; r++) {
    const t = r / 40, a = 0.6 * t, p = [0.3 * t, 0, 1 + 2 * t - 0.6 * t * t], q = [Math.sin(a) * 0.6, Math.sin(a) * 0.8, 0, Math.cos(a)];
    table.push([t, ...p, ...q, ...place(placed(bodies, { q_box: [p, q] })[0], [0.15, 0.1, 0.05]), 1e-12 * t]);
  }
  return { title: 'Tumbling box', columns: columns(names), scenes: [{ bodies, root: null, ground: null, gripper: { body: 0, point: [0.15, 0.1, 0.05] }, elements: [], wanted: null }], elements: [], cases: [{ index: 0, name: '', parameters: {}, status: 'done', error: null, scene: 0, table, events: [], metrics: [] }] };
}

/** A page that is served while its run goes on, and what its source says. */
export function served() {
  const full = arm(2, { rows: 201 }), [first, second] = full.cases;
  const empty = ({ table, status, events, metrics, ...one }) => ({ ...one, status: 'running', rows: 0, data: '' });
  const messages = [];
  for (let i = 0; i < 200; i += 50) messages.push({ case: 0, rows: first.table.slice(i, i + 50).map((row) => row.map((v) => (Number.isFinite(v) ? v : null))) });
  messages.push({ cases: [{ index: 1, name: second.name, parameters: second.parameters, scene: 0 }] }, { case: 1, rows: second.table.slice(0, 120) }, { status: 'done' });
  return { html: page({ version: '0.1.0', name: 'served', meshes: [], ...full, status: 'running', follow: '/events', cases: [empty(first)] }), messages, first };
}

/** Makes all pages. @param {string} folder */
export function make(folder) {
  mkdirSync(folder, { recursive: true });
  write(folder, 'arm', arm(3, { gap: true }));
  write(folder, 'sweep', arm(12, { failed: 4, title: 'Twelve orders of one strut', rows: 301 }));
  write(folder, 'humanoid', humanoid());
  write(folder, 'visuals', visuals());
  write(folder, 'floating', floating());
  const evil = `<script>alert(1)</script>"'><img src=x onerror=alert(1)>`;
  let n = 0;
  const tag = (text) => `${evil} ${text} ${n++ ? '' : 'long'.repeat(25000)}`;
  write(folder, 'hostile', { ...arm(3, { rows: 101, tag, title: `${evil} ${'title'.repeat(3000)}`, notes: [evil, 'note'.repeat(5000)], failed: 1 }), status: 'failed' });
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? '').href) {
  make(process.argv[2] ?? 'pages');
}
