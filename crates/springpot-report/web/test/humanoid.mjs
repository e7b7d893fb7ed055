/** Writes a humanoid of 31 joints with meshes that does squats, and prints its scenario's path. Usage: node test/humanoid.mjs FOLDER */

import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

/** Length of thigh and shank: alike, so that the hip stays above the ankle. */
const LEG = 0.4;

/** A surface around the z axis as a binary STL. @param {(s: number) => [number, number, number, number]} at z, shift in x, half widths in x and y for s = 0 … 1 */
function stl(at, rings = 36, parts = 40) {
  const corner = (i, k) => {
    const [z, shift, a, b] = at(i / rings), turn = (2 * Math.PI * k) / parts;
    return [shift + a * Math.cos(turn), b * Math.sin(turn), z];
  };
  const triangles = [];
  for (let i = 0; i < rings; i++) for (let k = 0; k < parts; k++) triangles.push([corner(i, k), corner(i, k + 1), corner(i + 1, k)], [corner(i + 1, k), corner(i, k + 1), corner(i + 1, k + 1)]);
  const out = Buffer.alloc(84 + 50 * triangles.length);
  out.writeUInt32LE(triangles.length, 80);
  triangles.forEach((corners, n) => corners.flat().forEach((v, j) => out.writeFloatLE(v, 96 + 50 * n + 4 * j)));
  return out;
}

/** A limb from z = 0 down: round ends, thickest at a third. */
const limb = (length, wide, narrow, bulge = 0) => stl((s) => {
  const end = Math.sqrt(Math.max(0, 1 - (2 * s - 1) ** 10)), r = (wide + (narrow - wide) * s + bulge * Math.sin(Math.PI * Math.min(1.5 * s, 1))) * end;
  return [0.02 - (length + 0.04) * s, -0.25 * bulge * Math.sin(Math.PI * s), r, 0.92 * r];
});
const MESHES = {
  pelvis: stl((s) => { const r = Math.sqrt(Math.max(0, 1 - (2 * s - 1) ** 4)); return [-0.09 + 0.18 * s, 0, 0.085 * r, 0.15 * r]; }),
  chest: stl((s) => { const r = Math.sqrt(Math.max(0, 1 - (2 * s - 1) ** 6)); return [-0.02 + 0.4 * s, 0, (0.08 + 0.035 * Math.sin(2.6 * s)) * r, (0.11 + 0.07 * Math.sin(2.4 * s)) * r]; }),
  head: stl((s) => { const r = Math.sqrt(Math.max(0, 1 - (2 * s - 1) ** 2)); return [0.01 + 0.23 * s, 0.015, 0.1 * r, 0.085 * r]; }),
  thigh: limb(LEG, 0.066, 0.042, 0.014), shank: limb(LEG, 0.04, 0.03, 0.02), upper_arm: limb(0.26, 0.04, 0.032, 0.008), forearm: limb(0.23, 0.034, 0.024, 0.008),
  hand: stl((s) => { const r = Math.sqrt(Math.max(0, 1 - (2 * s - 1) ** 6)); return [0.01 - 0.11 * s, 0, 0.016 * r, 0.038 * r]; }),
};

/** @param {string} folder @returns {string} the scenario */
export function humanoid(folder) {
  /** Joints: name, parent, place, axis, mass, visuals. */
  const links = [];
  const add = (name, parent, xyz, axis, mass, visual = '') => { links.push({ name, parent, xyz, axis, mass, visual }); return name; };
  const shape = (geometry, color, xyz = '0 0 0', rpy = '0 0 0') => `<visual><origin xyz="${xyz}" rpy="${rpy}"/><geometry>${geometry}</geometry><material name="${color}"/></visual>`;
  const mesh = (name) => shape(`<mesh filename="meshes/${name}.stl"/>`, 'shell');
  const drum = (r, l, rpy) => shape(`<cylinder radius="${r}" length="${l}"/>`, 'dark', '0 0 0', rpy);
  add('pelvis', null, '0 0 0', '', 9, mesh('pelvis'));
  add('waist_yaw', 'pelvis', '0 0 0.1', '0 0 1', 1, drum(0.07, 0.04, '0 0 0'));
  add('waist_roll', 'waist_yaw', '0 0 0.03', '1 0 0', 1);
  add('chest', 'waist_roll', '0 0 0.03', '0 1 0', 14, mesh('chest'));
  add('neck_yaw', 'chest', '0 0 0.38', '0 0 1', 0.5, drum(0.035, 0.08, '0 0 0'));
  add('head', 'neck_yaw', '0 0 0.05', '0 1 0', 4, mesh('head') + shape('<box size="0.03 0.13 0.045"/>', 'dark', '0.105 0 0.14'));
  for (const [side, s] of [['left', 1], ['right', -1]]) {
    add(`${side}_shoulder_pitch`, 'chest', `0 ${0.185 * s} 0.32`, '0 1 0', 0.8, drum(0.048, 0.06, '1.5708 0 0'));
    add(`${side}_shoulder_roll`, `${side}_shoulder_pitch`, `0 ${0.045 * s} 0`, '1 0 0', 0.6, shape('<sphere radius="0.05"/>', 'shell'));
    add(`${side}_upper_arm`, `${side}_shoulder_roll`, '0 0 -0.03', '0 0 1', 1.8, mesh('upper_arm'));
    add(`${side}_elbow`, `${side}_upper_arm`, '0 0 -0.26', '0 1 0', 0.5, drum(0.034, 0.07, '1.5708 0 0'));
    add(`${side}_forearm`, `${side}_elbow`, '0 0 -0.02', '0 0 1', 1.1, mesh('forearm'));
    add(`${side}_hand`, `${side}_forearm`, '0 0 -0.24', '0 1 0', 0.4, mesh('hand'));
    add(`${side}_fingers`, `${side}_hand`, '0 0 -0.095', '0 1 0', 0.15, shape('<box size="0.022 0.066 0.07"/>', 'dark', '0 0 -0.03'));
    add(`${side}_hip_yaw`, 'pelvis', `0 ${0.1 * s} -0.05`, '0 0 1', 1, drum(0.055, 0.04, '0 0 0'));
    add(`${side}_hip_roll`, `${side}_hip_yaw`, '0 0 -0.04', '1 0 0', 1, shape('<sphere radius="0.058"/>', 'dark'));
    add(`${side}_thigh`, `${side}_hip_roll`, '0 0 0', '0 1 0', 6, mesh('thigh'));
    add(`${side}_shank`, `${side}_thigh`, `0 0 ${-LEG}`, '0 1 0', 3, mesh('shank') + drum(0.045, 0.085, '1.5708 0 0'));
    add(`${side}_ankle`, `${side}_shank`, `0 0 ${-LEG}`, '0 1 0', 0.3, drum(0.03, 0.06, '1.5708 0 0'));
    add(`${side}_foot`, `${side}_ankle`, '0 0 0', '1 0 0', 1, shape('<box size="0.24 0.09 0.035"/>', 'dark', '0.045 0 -0.0525') + shape('<box size="0.1 0.07 0.04"/>', 'shell', '-0.005 0 -0.02'));
  }
  const joint = (name) => `${name}_joint`;
  const urdf = `<?xml version="1.0"?>
<robot name="humanoid">
<material name="shell"><color rgba="0.86 0.88 0.91 1"/></material>
<material name="dark"><color rgba="0.2 0.22 0.26 1"/></material>
${links.map(({ name, mass, visual }) => `<link name="${name}"><inertial><mass value="${mass}"/><inertia ixx="${0.01 * mass}" iyy="${0.01 * mass}" izz="${0.01 * mass}" ixy="0" ixz="0" iyz="0"/></inertial>${visual}</link>`).join('\n')}
${links.filter(({ parent }) => parent).map(({ name, parent, xyz, axis }) => `<joint name="${joint(name)}" type="revolute"><parent link="${parent}"/><child link="${name}"/><origin xyz="${xyz}"/><axis xyz="${axis}"/><limit lower="-3" upper="3" effort="300" velocity="20"/></joint>`).join('\n')}
</robot>
`;
  // Thigh and shank lean alike, so that the feet stay where they are; a sway about hips and ankles leaves them flat.
  const bend = '(0.5 - 0.42*cos(2*pi*0.4*t))', sway = '0.09*sin(2*pi*0.2*t)';
  const motion = {
    waist_yaw: '0.25*sin(2*pi*0.2*t)', waist_roll: '0.06*sin(2*pi*0.4*t)', chest: `0.35*${bend}`, neck_yaw: '0.4*sin(2*pi*0.1*t)', head: `-0.2*${bend}`,
  };
  for (const [side, s] of [['left', 1], ['right', -1]]) {
    Object.assign(motion, {
      [`${side}_shoulder_pitch`]: `-1.3*${bend} + ${0.25 * s}*sin(2*pi*0.8*t)`, [`${side}_shoulder_roll`]: String(0.16 * s), [`${side}_upper_arm`]: `${0.2 * s}*sin(2*pi*0.4*t)`,
      [`${side}_elbow`]: `-0.35 - 0.6*(1 - cos(2*pi*0.4*t))/2 - 0.15*sin(2*pi*1.6*t)`, [`${side}_forearm`]: `${0.3 * s}*sin(2*pi*0.8*t)`, [`${side}_hand`]: '0.3*sin(2*pi*0.8*t)', [`${side}_fingers`]: '0.4 + 0.4*sin(2*pi*0.8*t)',
      [`${side}_hip_yaw`]: '0', [`${side}_hip_roll`]: sway, [`${side}_thigh`]: `-${bend}`, [`${side}_shank`]: `2*${bend}`, [`${side}_ankle`]: `-${bend}`, [`${side}_foot`]: `-${sway}`,
    });
  }
  const point = (body, xyz) => `{ body = "${body}", point = [${xyz}] }`;
  const elements = [];
  const element = (name, place, law) => elements.push(`[[element]]\nname = "${name}"\n${place}\n${law}\n`);
  const between = (from, to, via = []) => `from = ${from}\n${via.length ? `via = [${via.join(', ')}]\n` : ''}to = ${to}\nrest_length = "start"`;
  const kelvin = (k, c) => `law = "fractional-kelvin-voigt"\nparameters = { k = ${k}, c = ${c}, alpha = 0.4 }`;
  for (const [side, s] of [['left', 1], ['right', -1]]) {
    element(`${side}_quadriceps`, between(point(`${side}_thigh`, '0.085, 0, -0.08'), point(`${side}_shank`, '0.055, 0, -0.09'), [point(`${side}_thigh`, '0.075, 0, -0.34')]), 'law = "fractional-zener"\nparameters = { k_e = "2 kN/m", k_m = "6 kN/m", c = "900 N*s^alpha/m", alpha = 0.35 }');
    element(`${side}_calf`, between(point(`${side}_shank`, '-0.065, 0, -0.08'), point(`${side}_foot`, '-0.07, 0, -0.03')), kelvin('"3 kN/m"', 400));
    element(`${side}_biceps`, between(point(`${side}_upper_arm`, '0.055, 0, -0.04'), point(`${side}_elbow`, '0.045, 0, -0.08')), kelvin('"600 N/m"', 90));
    element(`${side}_back`, between(point('pelvis', `-0.1, ${0.09 * s}, 0`), point('chest', `-0.115, ${0.1 * s}, 0.2`)), 'law = "kelvin-voigt"\nparameters = { k = "1.5 kN/m", c = "80 N*s/m" }');
    element(`${side}_ankle_pad`, `joint = "${joint(`${side}_ankle`)}"`, 'law = "springpot"\nparameters = { c = "25 N*m*s^alpha/rad", alpha = 0.3 }');
  }
  element('neck_pad', `joint = "${joint('head')}"`, 'law = "kelvin-voigt"\nparameters = { k = "12 N*m/rad", c = "0.6 N*m*s/rad" }');
  const base = 0.07 + 0.09;
  const scenario = `title = "Humanoid with viscoelastic muscles"

[robot]
urdf = "humanoid.urdf"
floating_base = true

[robot.gripper]
body = "right_hand"
point = [0, 0, -0.1]

${elements.join('\n')}
[motion]
kind = "prescribed"

[motion.joints]
floating_base = { y = "-${2 * LEG}*cos${bend}*sin(${sway})", z = "${base} + ${2 * LEG}*cos${bend}*cos(${sway})" }
${Object.entries(motion).map(([name, signal]) => `${joint(name)} = "${signal}"`).join('\n')}

[time]
end = "10 s"
output_step = "5 ms"
`;
  mkdirSync(join(folder, 'meshes'), { recursive: true });
  for (const [name, bytes] of Object.entries(MESHES)) writeFileSync(join(folder, 'meshes', `${name}.stl`), bytes);
  writeFileSync(join(folder, 'humanoid.urdf'), urdf);
  const file = join(folder, 'humanoid.toml');
  writeFileSync(file, scenario);
  return file;
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? '').href) console.log(humanoid(process.argv[2] ?? 'humanoid'));
