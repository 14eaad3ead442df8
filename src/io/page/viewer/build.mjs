// SPDX-License-Identifier: BSD-3-Clause
// Bundles the viewer into the template of the page of a scan, report.template.html, which CMake embeds into agrisee_io.
//   node build.mjs          write the template
//   node build.mjs --check  fail if the committed template is not what these sources give
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
// In a script element, `</script` and `<!--` change how the element is read, even in strings.
const safe = script.replace(/<\/(script)/gi, '<\\/$1').replace(/<!--/g, '<\\!--');
const page = readFileSync(join(here, 'page.html'), 'utf8')
  .replace('/*STYLE*/', () => style)
  .replace('/*SCRIPT*/', () => safe);

if (!/^[\x00-\x7f]*$/.test(page)) throw new Error('the page must be ASCII: write other characters as escapes');
if (page.split('@REPORT_DATA@').length !== 2) throw new Error('the page must contain @REPORT_DATA@ exactly once');
if (page.includes(')agrisee"')) throw new Error('the page contains the delimiter of the C++ literals that it is embedded as');

if (process.argv.includes('--check')) {
  if (readFileSync(target, 'utf8') !== page) {
    console.error('report.template.html is not what its sources give: run `npm run build` in src/io/page/viewer and commit it');
    process.exit(1);
  }
  console.log('report.template.html is what its sources give');
} else {
  writeFileSync(target, page);
  console.log(`report.template.html: ${(page.length / 1024).toFixed(0)} KB`);
}
