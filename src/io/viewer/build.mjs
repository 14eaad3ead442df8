// SPDX-License-Identifier: BSD-3-Clause
// Bundles the viewer into one page, report.template.html, which CMake embeds into agrisee_io.
//   node build.mjs          write it
//   node build.mjs --check  fail when the committed one is not what these sources give
import { build } from 'esbuild';
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const target = join(here, 'report.template.html');
const options = { bundle: true, minify: true, write: false, charset: 'ascii', target: ['es2020'], absWorkingDir: here };
const output = async (entry, extra) => (await build({ ...options, entryPoints: [entry], ...extra })).outputFiles[0].text.trim();

const script = await output('main.js', { format: 'iife', legalComments: 'inline' });
const style = await output('style.css', {});
// Within a script element `</script` and `<!--` would end or change the reading of it, in a string too.
const safe = script.replace(/<\/(script)/gi, '<\\/$1').replace(/<!--/g, '<\\!--');
const page = readFileSync(join(here, 'page.html'), 'utf8')
  .replace('/*STYLE*/', () => style)
  .replace('/*SCRIPT*/', () => safe);

if (!/^[\x00-\x7f]*$/.test(page)) throw new Error('the page has to be ASCII: write other characters as escapes');
if (page.split('@REPORT_DATA@').length !== 2) throw new Error('the page has to hold @REPORT_DATA@ once');
if (page.includes(')agrisee"')) throw new Error('the page holds the delimiter of the C++ literals it is embedded as');

if (process.argv.includes('--check')) {
  if (readFileSync(target, 'utf8') !== page) {
    console.error('report.template.html is not what its sources give: run `npm run build` in src/io/viewer and commit it');
    process.exit(1);
  }
  console.log('report.template.html is what its sources give');
} else {
  writeFileSync(target, page);
  console.log(`report.template.html: ${(page.length / 1024).toFixed(0)} KB`);
}
