/** Validates every model in the folder that MODELS names: no errors, no warnings. */

import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { describe, test } from 'node:test';
import validator from 'gltf-validator';

const folder = process.env.MODELS && resolve(process.env.MODELS);
const files = folder ? readdirSync(folder).filter((file) => /\.(glb|gltf)$/.test(file)).sort() : [];

test('MODELS names a folder with models', () => assert.ok(files.length, String(folder)));

describe('models', () => {
  for (const file of files) {
    test(file, async () => {
      const report = await validator.validateBytes(new Uint8Array(readFileSync(join(folder, file))), { uri: file, maxIssues: 20 });
      const { numErrors, numWarnings, messages } = report.issues;
      assert.deepEqual([numErrors, numWarnings], [0, 0], JSON.stringify(messages.slice(0, 5), null, 1));
      assert.ok(report.info.totalTriangleCount > 0);
    });
  }
});
