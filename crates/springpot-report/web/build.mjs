/** Bundles the page into viewer.html, one file that needs nothing else. The same sources give the same bytes. Usage: node build.mjs [FOLDER], without it ../assets */

import { createHash } from 'node:crypto';
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const target = ['chrome109', 'firefox115', 'safari16.4'];
const common = { bundle: true, minify: true, write: false, target, legalComments: 'none', charset: 'utf8', logLevel: 'warning', absWorkingDir: here('.') };

const text = (result) => result.outputFiles[0].text.trim();
const script = text(await build({ ...common, entryPoints: ['src/main.js'], format: 'iife', define: { 'process.env.NODE_ENV': '"production"' }, banner: { js: '/*! @license three.js: Copyright 2010-2026 three.js authors, SPDX-License-Identifier: MIT */' } }));
const style = text(await build({ ...common, entryPoints: ['src/style.css'] }));

/** Only this script and this style may run, whatever the data says. */
const hash = (body) => `'sha256-${createHash('sha256').update(body).digest('base64')}'`;
const policy = `default-src 'none'; script-src ${hash(script)}; style-src ${hash(style)}; img-src data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'`;

for (const [name, body] of [['script', script], ['style', style]]) {
  if (body.includes('@DATA@') || new RegExp(`</${name}`, 'i').test(body)) throw new Error(`the ${name} holds what would end it`);
  if (body.includes(here('.')) || /\/(home|root|work|Users)\//.test(body)) throw new Error(`the ${name} holds a path of this machine`);
}

const parts = { '@POLICY@': policy, '@STYLE@': style, '@SCRIPT@': script };
const page = (await readFile(here('src/page.html'), 'utf8')).replace(/@(POLICY|STYLE|SCRIPT)@/g, (name) => parts[name]);
if (page.split('@DATA@').length !== 2) throw new Error('the place of the data must be there once');
const folder = process.argv[2] ?? here('../assets');
await mkdir(folder, { recursive: true });
await writeFile(join(folder, 'viewer.html'), page);
await writeFile(join(folder, 'THREE-LICENSE.txt'), await readFile(here('node_modules/three/LICENSE'), 'utf8'));
console.log(`viewer.html: ${Math.round(Buffer.byteLength(page) / 1000)} kB`);
