// SPDX-License-Identifier: BSD-3-Clause
// Opens reports in a headless Chromium and uses them as a reader would.
//   node report_test.mjs AGRISEE WORKDIR CHROMIUM
// Ends with 77 where playwright-core is missing (`npm ci` in tests/report installs it; no browser is downloaded).
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { strict as assert } from 'node:assert';

let chromium;
try {
  ({ chromium } = await import('playwright-core'));
} catch {
  console.log('SKIPPED: playwright-core is not installed; run `npm ci` in tests/report');
  process.exit(77);
}
const [agrisee, work, executablePath] = process.argv.slice(2).map((p) => resolve(p));
rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
const run = (...args) => execFileSync(agrisee, args, { cwd: work, stdio: ['ignore', 'ignore', 'pipe'] });

// A scan, a cloud from elsewhere, one without fruit, one without points, one view.
run('make-truss', '--total', '4', '--hidden', '1', '--seed', '3', '-o', 't');
const scene = join(work, 't/scene.yaml');
writeFileSync(scene, readFileSync(scene, 'utf8').replace(/width: *1024/, 'width: 512').replace(/height: *768/, 'height: 384'));
run('scan', 't/scene.yaml', '-o', 'scan', '--noise', 'l515', '--seed', '5', '--max-views', '5');
run('scan', 't/scene.yaml', '-o', 'one', '--max-views', '1');
run('scan', 't/scene.yaml', '-o', 'see', '--planner', 'see', '--max-views', '3');
run('process', 'scan/cloud.ply', '-o', 'processed', '--viewpoint', '0,0,0.2');
const ply = (points) => `ply\nformat ascii 1.0\nelement vertex ${points.length}\nproperty float x\nproperty float y\nproperty float z\nend_header\n${points.join('\n')}\n`;
writeFileSync(join(work, 'three.ply'), ply(['0 0 0', '1 1 1', '1e30 0 0']));
writeFileSync(join(work, 'none.ply'), ply([]));
run('process', 'three.ply', '-o', 'three');
run('process', 'none.ply', '-o', 'none');
// Texts that try to be markup, in every place that shows one.
const hostile = '</script><img src=x onerror="window.hacked=1"><b>&';
mkdirSync(join(work, 'hostile'));
const spoil = (page) => page.replace(/(<script id="data"[^>]*>)(.*?)(<\/script>)/s, (_, a, json, c) => {
  const data = JSON.parse(json);
  Object.assign(data.run, { scene: hostile, noise: hostile, planner: hostile, version: hostile, preset: hostile, stop_reason: hostile });
  data.run.parameters = { [hostile]: hostile };
  for (const f of data.fruits) f.found_by = hostile;
  for (const curve of data.curves) curve.name = hostile;
  return a + JSON.stringify(data).replaceAll('<', '\\u003c') + c;
});
writeFileSync(join(work, 'hostile/report.html'), spoil(readFileSync(join(work, 'scan/report.html'), 'utf8')));

const browser = await chromium.launch({
  executablePath,
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
    '--disable-background-networking', '--disable-component-update', '--disable-sync'],
});

/** Opens a report; afterwards, nothing may have been loaded and nothing complained of. */
async function reading(name, size, read) {
  const page = await browser.newPage({ viewport: size });
  const complaints = [], requests = [];
  page.on('console', (m) => { if (['error', 'warning'].includes(m.type()) && !/GPU stall|GL Driver Message/.test(m.text())) complaints.push(m.text()); });
  page.on('pageerror', (e) => complaints.push(e.message));
  page.on('request', (r) => requests.push(r.url()));
  const address = pathToFileURL(join(work, name, 'report.html')).href;
  await page.goto(address);
  await page.waitForSelector('body[data-ready=true]');
  await page.waitForFunction(() => Number(document.getElementById('canvas').dataset.frames) > 0);
  await page.waitForTimeout(100);
  await read(page);
  await page.screenshot({ path: join(work, `${name}_${size.width}.png`) });
  assert.deepEqual(complaints, [], `${name}: complaints`);
  assert.deepEqual(requests, [address], `${name}: loads`);
  assert.equal(await page.evaluate(() => window.hacked), undefined);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  assert.ok(wide <= 0, `${name}: ${wide} pixels wider than a window of ${size.width}`);
  await page.close();
  console.log(`ok ${name} at ${size.width} x ${size.height}`);
}

/** How many pixels of the canvas look like each of the colours (#rrggbb), by hue; and how many are drawn at all. */
const pixels = (page, colors) => page.evaluate(async (wanted) => {
  await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  const source = document.getElementById('canvas'), copy = document.createElement('canvas');
  [copy.width, copy.height] = [source.width, source.height];
  const context = copy.getContext('2d');
  context.drawImage(source, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  const unit = (v) => { const l = Math.hypot(...v); return v.map((x) => x / l); };
  const hues = wanted.map((c) => unit([1, 3, 5].map((i) => parseInt(c.slice(i, i + 2), 16))));
  const counts = hues.map(() => 0);
  let drawn = 0;
  for (let i = 0; i < data.length; i += 4) {
    if (data[i + 3] < 128) continue;
    ++drawn;
    const p = unit([data[i] + 1e-9, data[i + 1], data[i + 2]]);
    hues.forEach((h, k) => { if (h[0] * p[0] + h[1] * p[1] + h[2] * p[2] > 0.994) ++counts[k]; });
  }
  return { counts, drawn };
}, colors);
const wide = { width: 1600, height: 1000 }, narrow = { width: 420, height: 900 };

for (const size of [wide, narrow])
  await reading('scan', size, async (page) => {
    const { colors, views, fruits } = JSON.parse(await page.textContent('#data'));
    assert.equal(fruits.length, 4);
    assert.equal(await page.locator('#fruits tbody tr').count(), 4);
    assert.equal(await page.textContent('#scene'), 'truss_4_1_s3');
    const hues = fruits.map((f) => colors[f.id]);

    // The canvas shows every fruit in its colour.
    await page.click('[data-camera=fruit]');
    const all = await pixels(page, hues);
    all.counts.forEach((n, i) => assert.ok(n > 300, `fruit ${i + 1}: ${n} pixels of its colour`));

    // The slider goes back: view, bars and points follow.
    const slide = (k) => page.$eval('#slider', (e, value) => { e.value = value; e.dispatchEvent(new Event('input')); }, k);
    assert.equal(await page.getAttribute('body', 'data-view'), String(views.length));
    await slide(1);
    assert.equal(await page.getAttribute('body', 'data-view'), '1');
    assert.match(await page.textContent('#view-text'), new RegExp(`^View 1 of ${views.length} `));
    const first = await pixels(page, hues);
    assert.ok(first.drawn !== all.drawn, 'the canvas does not follow the slider');
    await slide(views.length);
    const again = await pixels(page, hues);
    assert.deepEqual(again, all);
    await page.focus('#slider');
    await page.keyboard.press('ArrowLeft');
    assert.equal(await page.getAttribute('body', 'data-view'), String(views.length - 1));
    await page.keyboard.press('ArrowRight');

    // A row highlights its fruit, and the rest steps back; a second click ends that.
    const row = (id) => page.locator(`#fruits tr[data-fruit="${id}"]`);
    await row(2).click();
    assert.equal(await row(2).getAttribute('aria-selected'), 'true');
    assert.match(await page.textContent('#detail'), /^Fruit 2/);
    const chosen = await pixels(page, hues);
    assert.ok(chosen.counts[1] > 0.8 * all.counts[1], 'the chosen fruit lost its colour');
    assert.ok(chosen.counts[0] < 0.3 * all.counts[0], 'the other fruit kept theirs');
    await row(2).click();
    assert.equal(await page.locator('#fruits tr[aria-selected=true]').count(), 0);
    assert.ok(await page.isHidden('#detail'));

    // A click on a fruit in the view highlights its row; one beside it ends that.
    await page.locator('#canvas').scrollIntoViewIfNeeded();
    const [x, y] = await page.$eval('#labels [data-fruit="1"]', (e) => [Number(e.dataset.x), Number(e.dataset.y)]);
    await page.click('#canvas', { position: { x, y } });
    const id = await page.getAttribute('body', 'data-fruit');
    assert.notEqual(id, '0', 'a click on a fruit found none');
    assert.equal(await row(id).getAttribute('aria-selected'), 'true');
    await page.click('#canvas', { position: { x: 5, y: 200 } });
    assert.equal(await page.getAttribute('body', 'data-fruit'), '0');
    await page.click('#labels [data-fruit="3"]');
    assert.equal(await row(3).getAttribute('aria-selected'), 'true');
    await page.click('#detail button');

    // Layers, cameras, replay, filter.
    await page.click('#layers summary');
    await page.click('[data-layer=fruit]');
    await page.click('[data-layer=bodies]');
    // Not fruit 1: its red is that of the frames' axes, of which more remains the smaller the picture.
    assert.ok((await pixels(page, hues)).counts[2] < 0.2 * all.counts[2], 'the layer is still there');
    await page.click('[data-layer=fruit]');
    await page.click('[data-layer=bodies]');
    for (const name of ['merged', 'keep_out', 'approaches']) await page.click(`[data-layer=${name}]`);
    await page.click('#layers summary');
    for (const camera of ['top', 'sensor', 'scene']) {
      await page.click(`[data-camera=${camera}]`);
      assert.ok((await pixels(page, [])).drawn > 500, `camera ${camera} shows nothing`);
    }
    await page.click('#play');
    await page.waitForFunction(() => Number(document.body.dataset.view) > 1);  // a slow machine may not show every view
    await page.click('#play');
    await slide(views.length);
    assert.ok((await page.locator('#curves path').count()) >= 2, 'no curves');
    await page.click('#parameters summary');
    await page.fill('#filter', 'gain.');
    assert.ok((await page.locator('#parameter-table tr:visible').count()) > 3);
    assert.equal(await page.locator('#parameter-table tr:visible', { hasText: 'sor' }).count(), 0);
    await page.click('#parameters summary');
    await page.evaluate(() => window.scrollTo(0, 0));
  });

await reading('one', wide, async (page) => {
  assert.ok(await page.isHidden('#replay'));
  assert.ok((await pixels(page, [])).drawn > 2000);
});
await reading('see', wide, async (page) => {
  await page.click('#layers summary');
  assert.equal(await page.locator('[data-layer=frontier]').count(), 1, 'SEE++ has left no frontier');
});
await reading('processed', wide, async (page) => {
  assert.ok(await page.isHidden('#replay'));
  assert.ok(await page.isHidden('#curves-section'));
  assert.equal(await page.locator('[data-layer=sensors], [data-layer=arm]').count(), 0);
  assert.ok((await pixels(page, [])).drawn > 20000);
});
for (const name of ['three', 'none'])
  await reading(name, wide, async (page) => {
    assert.ok(await page.isVisible('#no-fruit'));
    assert.equal(await page.isVisible('#notice'), name === 'none');
  });
await reading('hostile', wide, async (page) => {
  assert.equal(await page.textContent('#scene'), hostile);
  assert.equal(await page.locator('img').count(), 0);
  await page.click('#fruits tbody tr');
  assert.ok((await page.textContent('#detail')).includes('<img'));
  await page.click('#parameters summary');
  assert.ok((await page.textContent('#parameter-table')).includes(hostile));
});
await browser.close();
if (!existsSync(join(work, 'scan_1600.png'))) process.exit(1);
