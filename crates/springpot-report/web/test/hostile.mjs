/** Writes a scenario whose names and values try to break out of a page. Usage: node test/hostile.mjs FOLDER; prints the scenario's path. */

import { mkdirSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { pathToFileURL } from 'node:url';

/** Ends scripts and comments, opens tags, attributes and templates, breaks lines, turns the direction of text. */
const EVIL = '</script><script>alert(1)</script><img src=x onerror=alert(2)>"\'`${alert(3)}<!--<script>\u2028\u2029\u202edlrow\u202c\u0085&lt;&#60;\\u003c]]>';
const LONG = 100000;

/** A JSON string is a TOML string. @param {string} text */
const toml = (text) => JSON.stringify(text);
/** @param {string} text */
const xml = (text) => text.replace(/[&<>"'\n\t]/g, (c) => `&#${c.charCodeAt(0)};`);

/** @param {string} folder @returns {string} the scenario */
export function hostile(folder) {
  // Files may be called anything but have no slash: it parts a folder and a file.
  const samples = '<\u202e/script><script>alert(4)<,"\'`.csv', mesh = '<img src=x onerror=alert(5)>"\'.stl';
  const name = '<img src=x onerror=alert(6)>"\'`&lt;\u202e';
  const links = [`base ${EVIL}`, `boom ${EVIL}\n"a",b`, `tip ${EVIL}${'l'.repeat(LONG)}`];
  const joints = [`turn ${EVIL}\n"q",r`, `lift ${EVIL}${'j'.repeat(LONG)}`];
  const link = (text, shape, z) => `<link name="${xml(text)}"><inertial><origin xyz="0.1 0 0"/><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><origin xyz="0.2 0 ${z}"/><geometry>${shape}</geometry></visual></link>`;
  const joint = (text, parent, child, x) => `<joint name="${xml(text)}" type="continuous"><parent link="${xml(parent)}"/><child link="${xml(child)}"/><origin xyz="${x} 0 0.1"/><axis xyz="0 1 0"/></joint>`;
  const urdf = `<?xml version="1.0"?>
<robot name="${xml(EVIL)}">
${link(links[0], '<box size="0.1 0.1 0.1"/>', 0)}
${link(links[1], '<box size="0.4 0.04 0.04"/>', 0)}
${link(links[2], `<mesh filename="${xml(mesh)}"/>`, 0)}
${joint(joints[0], links[0], links[1], 0)}
${joint(joints[1], links[1], links[2], 0.4)}
</robot>
`;
  const path = `motion.joints.${toml(joints[0])}`;
  const scenario = `title = ${toml(EVIL + 'title'.repeat(LONG / 5))}

[robot]
urdf = ${toml(`${name}.urdf`)}

[robot.gripper]
body = ${toml(links[2])}
point = [0.3, 0, 0]

[[element]]
name = "strut"
from = { body = ${toml(links[0])}, point = [0.1, 0, 0.4] }
to = { body = ${toml(links[1])}, point = [0.3, 0, 0] }
rest_length = "start"
law = "fractional-kelvin-voigt"
parameters = { k = 100, c = 20, alpha = 0.5 }

[[element]]
name = "turn-${'e'.repeat(LONG)}"
joint = ${toml(joints[1])}
network = "parallel(spring(k), ${'n'.repeat(500)}: springpot(c, a))"
parameters = { k = 5, c = 2, a = 0.4 }

[motion]
kind = "prescribed"

[motion.joints]
${toml(joints[0])} = "0.4*sin(3*t)"
${toml(joints[1])} = "0.5*sin(2*t)"

[time]
end = "2 s"
output_step = "10 ms"

[[sweep]]
parameter = ${toml(path)}
values = ["0.4*sin(3*t)", { csv = ${toml(samples)}, column = ${toml(EVIL)} }, { expression = "${'0.1*t+'.repeat(200)}0.2" }]

[[metric]]
name = "peak-${'m'.repeat(1000)}"
of = ${toml(`q.${joints[0]}`)}
kind = "max"

[[figure]]
name = "angle"
title = ${toml(EVIL)}
y = ["q.*"]
y_label = ${toml(EVIL)}
legend = ${toml(EVIL)}
`;
  const rows = Array.from({ length: 201 }, (_, i) => `${i / 100},${0.3 * Math.sin((5 * i) / 100)}`);
  mkdirSync(dirname(join(folder, samples)), { recursive: true });
  writeFileSync(join(folder, samples), `t,"${EVIL.replace(/"/g, '""')}"\n${rows.join('\n')}\n`);
  writeFileSync(join(folder, mesh), 'solid no mesh\n');
  writeFileSync(join(folder, `${name}.urdf`), urdf);
  const file = join(folder, `${name}.toml`);
  writeFileSync(file, scenario);
  return file;
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? '').href) console.log(hostile(process.argv[2] ?? 'hostile'));
