// SPDX-License-Identifier: BSD-3-Clause
// Whether report.template.html is what its sources give; ends with 77 where esbuild is not installed.
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const viewer = fileURLToPath(new URL('../../src/io/page/viewer/', import.meta.url));
if (!existsSync(viewer + 'node_modules/esbuild') || !existsSync(viewer + 'node_modules/three')) {
  console.log('SKIPPED: esbuild and three.js are not installed; run `npm ci` in src/io/page/viewer');
  process.exit(77);
}
process.exit(spawnSync(process.execPath, [viewer + 'build.mjs', '--check'], { stdio: 'inherit' }).status ?? 1);
