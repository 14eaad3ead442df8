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
run('process', 'scan/cloud.ply', '-o', 'processed');
const ply = (points) => `ply\nformat ascii 1.0\nelement vertex ${points.length}\nproperty float x\nproperty float y\nproperty float z\nend_header\n${points.join('\n')}\n`;
writeFileSync(join(work, 'three.ply'), ply(['0 0 0', '1 1 1', '1e30 0 0']));
writeFileSync(join(work, 'none.ply'), ply([]));
run('process', 'three.ply', '-o', 'three');
run('process', 'none.ply', '-o', 'none');
/** A copy of a page with other data. */
function changed(from, to, change) {
  mkdirSync(join(work, to), { recursive: true });
  const page = readFileSync(join(work, from, 'report.html'), 'utf8');
  writeFileSync(join(work, to, 'report.html'), page.replace(/(<script id="data"[^>]*>)(.*?)(<\/script>)/s, (_, a, json, c) => {
    const data = JSON.parse(json);
    change(data);
    return a + JSON.stringify(data).replaceAll('<', '\\u003c') + c;
  }));
}
// What a scan rarely shows: views that were discarded, two trusses, a colour image, a crowd of fruit in one line of sight.
changed('scan', 'rare', (data) => {
  data.run.discarded_views = [{ view: 1, reason: 'repeated_frame' }, { view: 2, reason: 'contradicts_others' }];
  data.run.warnings = ['a matrix was rounded'];
  data.fruits.forEach((f, i) => (f.truss = i < 3 ? 1 : 2));
  data.views[0].color = 'data:image/png;base64,' + data.depth[0].png;
  data.views[3].color = 'https://example.com/a.png';
});
changed('scan', 'crowd', (data) => {
  for (let id = 5; id <= 40; ++id) {
    const f = JSON.parse(JSON.stringify(data.fruits[id % 4]));
    data.fruits.push({ ...f, id, position_world: f.position_world.map((x) => x + 0.0007 * (id - 5)) });
    data.colors[id] = data.colors[1 + (id % 4)];
  }
});
changed('three', 'why', (data) => { data.run.no_fruit = 'none of 2 bodies was accepted: 2 were too small'; });
// Texts that try to be markup, in every place that shows one.
const hostile = '</script><img src=x onerror="window.hacked=1"><b>&';
changed('scan', 'hostile', (data) => {
  Object.assign(data.run, { scene: hostile, noise: hostile, planner: hostile, version: hostile, preset: hostile, stop_reason: hostile });
  data.run.discarded_views = [{ view: 0, reason: hostile }];
  Object.assign(data.run, { time: hostile, frame_id: hostile, warnings: [hostile] });
  data.run.parameters = { [hostile]: hostile };
  for (const f of data.fruits) Object.assign(f, { found_by: hostile, truss: hostile + f.id });
  for (const curve of data.curves) curve.name = hostile;
  data.views[0].color = data.depth[0].png = hostile;
});

const browser = await chromium.launch({
  executablePath,
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
    '--disable-background-networking', '--disable-component-update', '--disable-sync'],
});

/** Opens a report; afterwards, nothing may have been loaded and nothing complained of. */
async function reading(name, size, read, options = {}) {
  const page = await browser.newPage({ viewport: size, ...options });
  const complaints = [], requests = [];
  page.on('console', (m) => { if (['error', 'warning'].includes(m.type()) && !/GPU stall|GL Driver Message/.test(m.text())) complaints.push(m.text()); });
  page.on('pageerror', (e) => complaints.push(e.message));
  page.on('request', (r) => { if (!/^(data|blob):/.test(r.url())) requests.push(r.url()); });
  const address = pathToFileURL(join(work, name, 'report.html')).href;
  await page.goto(address);
  await page.waitForSelector('body[data-ready=true]');
  await page.waitForFunction(() => Number(document.getElementById('canvas').dataset.frames) > 0);
  await page.waitForTimeout(100);
  await read(page);
  await page.screenshot({ path: join(work, `${name}_${size.width}${options.colorScheme ?? ''}.png`) });
  assert.deepEqual(complaints, [], `${name}: complaints`);
  assert.deepEqual([...new Set(requests)], [address], `${name}: loads`);
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

/** That no number of a fruit covers another one, or the controls and legends of the view. */
async function checkBadges(page, name) {
  const boxes = await page.evaluate(() => {
    const box = (e) => { const b = e.getBoundingClientRect(); return { name: e.id || e.textContent, left: b.left, right: b.right, top: b.top, bottom: b.bottom }; };
    return { badges: [...document.querySelectorAll('#labels b:not([hidden])')].map(box),
      rest: ['cameras', 'layers', 'scale', 'triad', 'measured'].map((id) => document.getElementById(id)).filter((e) => !e.hidden).map(box), view: box(document.getElementById('viewport')) };
  });
  const { badges, rest, view } = boxes, slack = 0.6;
  const covers = (a, b) => a.left < b.right - slack && b.left < a.right - slack && a.top < b.bottom - slack && b.top < a.bottom - slack;
  const round = (a) => ({ x: (a.left + a.right) / 2, y: (a.top + a.bottom) / 2, r: (a.bottom - a.top) / 2 });
  badges.forEach((a, i) => {
    for (const b of rest) assert.ok(!covers(a, b), `${name}: number ${a.name} covers ${b.name}`);
    for (const b of badges.slice(0, i)) {
      const [p, q] = [round(a), round(b)];
      assert.ok(Math.hypot(p.x - q.x, p.y - q.y) >= p.r + q.r - slack, `${name}: number ${a.name} covers number ${b.name}`);
    }
    assert.ok(a.left >= view.left - slack && a.right <= view.right + slack && a.top >= view.top - slack && a.bottom <= view.bottom + slack, `${name}: number ${a.name} leaves the view`);
  });
  return badges.length;
}
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
    assert.match(await page.textContent('#view-text'), new RegExp(`^View 0 \\(1 of ${views.length}\\) `));
    const first = await pixels(page, hues);
    assert.ok(first.drawn !== all.drawn, 'the canvas does not follow the slider');
    await slide(views.length);
    const again = await pixels(page, hues);
    assert.deepEqual(again, all);
    await checkBadges(page, `scan, ${size.width}`);
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

// The table: sorted from the keyboard, downloaded, poses copied; distances; images; as print; dark.
await reading('scan', wide, async (page) => {
  const { fruits, depth, views } = JSON.parse(await page.textContent('#data'));
  const order = () => page.$$eval('#fruits tbody tr', (rows) => rows.map((r) => Number(r.dataset.fruit)));
  const head = page.locator('#fruits th', { hasText: 'z, mm' });
  await page.focus('#fruits th button');
  for (let i = 0; i < 3; ++i) await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  assert.equal(await head.getAttribute('aria-sort'), 'ascending');
  const byHeight = [...fruits].sort((a, b) => a.center_world[2] - b.center_world[2]).map((f) => f.id);
  assert.deepEqual(await order(), byHeight);
  await page.keyboard.press(' ');
  assert.equal(await head.getAttribute('aria-sort'), 'descending');
  assert.deepEqual(await order(), byHeight.reverse());

  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#csv')]);
  assert.equal(download.suggestedFilename(), 'truss_4_1_s3_fruits.csv');
  assert.equal(readFileSync(await download.path(), 'utf8'), readFileSync(join(work, 'scan/fruits.csv'), 'utf8'));

  await page.click('#fruits tr[data-fruit="2"]');
  await page.click('#detail button:text("Copy pose")');
  await page.waitForSelector('#detail button:text("Copied")');
  const two = fruits.find((f) => f.id === 2);
  assert.deepEqual(JSON.parse(await page.evaluate(() => navigator.clipboard.readText())), { frame: 'world', position: two.position_world, orientation: two.orientation_world });

  // Between two centres, and two points of the surface.
  await page.click('[data-camera=fruit]');
  await page.click('#measure');
  await checkBadges(page, 'measuring');
  await page.click('#labels [data-fruit="1"]');
  await page.click('#labels [data-fruit="3"]');
  const between = Math.hypot(...[0, 1, 2].map((a) => fruits[0].center_world[a] - fruits[2].center_world[a]));
  assert.ok((await page.textContent('#measured')).startsWith(`${(1000 * between).toFixed(1)}\u00a0mm`), await page.textContent('#measured'));
  const at = (id) => page.$eval(`#labels [data-fruit="${id}"]`, (e) => ({ x: Number(e.dataset.x), y: Number(e.dataset.y) }));
  const one = await at(1);
  await page.click('#canvas', { position: one });
  await page.click('#canvas', { position: { x: one.x + 12, y: one.y } });
  await page.click('#measured button');
  const line = JSON.parse(await page.evaluate(() => navigator.clipboard.readText()));
  const off = (p) => Math.min(...fruits.map((f) => Math.abs(Math.hypot(...[0, 1, 2].map((a) => p[a] - f.center_world[a])) - f.radii[1])));
  for (const p of [line.from, line.to]) assert.ok(off(p) < 0.006, `a point ${off(p)} m from the surface of the nearest fruit`);
  assert.ok(line.distance > 0.001 && line.distance < 0.03, `${line.distance} m between neighbours on the surface`);
  await page.click('#canvas', { position: { x: 5, y: 200 } });
  assert.match(await page.textContent('#measured'), /no point/);
  await page.keyboard.press('Escape');
  assert.ok(await page.isHidden('#measured'));
  assert.equal(await page.getAttribute('body', 'data-fruit'), '2', 'measuring changed the selection');

  // The depth image follows the slider, and says what it shows.
  assert.equal(depth.length, views.length);
  for (const k of [views.length, 1]) {
    await page.$eval('#slider', (e, value) => { e.value = value; e.dispatchEvent(new Event('input')); }, k);
    await page.waitForSelector(`#images canvas[data-view="${k}"]`);
  }
  const middle = await page.$eval('#images canvas', (c) => {
    const { data } = c.getContext('2d').getImageData(0, 0, c.width, c.height);
    const near = [];
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] === 255 && data[i] > 200 && data[i + 1] > 200 && data[i + 2] < 90) near.push(i / 4);
    return { near: near.length, first: near[0], width: c.width, height: c.height };
  });
  assert.ok(middle.near > 0, 'nothing is yellow, so nothing is near');
  await page.hover('#images canvas', { position: await page.$eval('#images canvas', (c, i) => ({ x: ((i % c.width) + 0.5) * (c.clientWidth / c.width), y: (Math.floor(i / c.width) + 0.5) * (c.clientHeight / c.height) }), middle.first) });
  const shown = Number((await page.textContent('#images p')).replace(/\D/g, '')) / 1000;
  assert.ok(shown >= depth[0].near - 0.001 && shown < depth[0].near + 0.05, `${shown} m at the nearest place, of ${depth[0].near} m`);
  await page.mouse.move(300, 500);

  await page.emulateMedia({ media: 'print' });
  for (const id of ['cameras', 'layers', 'theme', 'slider', 'csv']) assert.ok(await page.isHidden('#' + id), `${id} is printed`);
  const print = await page.evaluate(() => ({ body: document.body.getBoundingClientRect(), aside: document.getElementById('aside').getBoundingClientRect(),
    table: document.getElementById('fruits').getBoundingClientRect(), stage: document.getElementById('stage').getBoundingClientRect(), ink: getComputedStyle(document.body).color }));
  assert.ok(print.aside.top >= print.stage.bottom - 1 && print.aside.width > 0.95 * print.body.width, 'the print has columns');
  await checkBadges(page, 'print');
  await page.emulateMedia({ media: 'screen' });
}, { permissions: ['clipboard-read', 'clipboard-write'] });

// Dark where the system is, light where the reader wants it.
await reading('scan', wide, async (page) => {
  const paper = () => page.$eval('aside', (e) => getComputedStyle(e).backgroundColor.match(/\d+/g).map(Number)[0]);
  assert.ok((await paper()) < 60, 'not dark');
  await page.click('#theme');
  assert.ok((await paper()) > 200, 'not light');
  await page.reload();
  await page.waitForSelector('body[data-ready=true]');
  assert.ok((await paper()) > 200, 'the choice is forgotten');
  await page.click('#theme');
  await page.emulateMedia({ media: 'print' });
  assert.ok((await paper()) > 200, 'the print is dark');
  await page.emulateMedia({ media: 'screen' });
}, { colorScheme: 'dark' });

await reading('rare', wide, async (page) => {
  assert.match(await page.textContent('#warnings'), /^2 of 5 views were discarded: view 1 \(.*repeats.*\); view 2 \(.*pose is wrong\)\.a matrix was rounded$/);
  assert.match(await page.textContent('#summary'), /5views2discarded|views.*discarded/);
  assert.equal(await page.locator('#curves .discarded').count(), 2);
  assert.equal(await page.locator('#fruits th', { hasText: 'Truss' }).count(), 1);
  const slide = (k) => page.$eval('#slider', (e, value) => { e.value = value; e.dispatchEvent(new Event('input')); }, k);
  await slide(2);
  assert.match(await page.textContent('#view-text'), /discarded/);
  await slide(4);
  assert.equal(await page.locator('#images img:visible').count(), 0, 'an image from elsewhere');
  await slide(1);
  assert.equal(await page.locator('#images img:visible').count(), 1, 'no colour image');
});
for (const size of [wide, narrow])
  await reading('crowd', size, async (page) => {
    for (const camera of ['fruit', 'scene', 'top']) {
      await page.click(`[data-camera=${camera}]`);
      await pixels(page, []);
      assert.ok((await checkBadges(page, `crowd, ${camera}, ${size.width}`)) >= 30, `${camera}: numbers are missing`);
    }
  });

// While a scan runs, its page follows, and looks as before.
const final = readFileSync(join(work, 'scan/report.html'), 'utf8');
changed('scan', 'live', (data) => {
  data.running = true;
  data.views.pop();
});
await reading('live', wide, async (page) => {
  assert.match(await page.textContent('#live'), /running/);
  await page.click('#labels [data-fruit="3"]');
  await page.click('[data-camera=top]');
  const scale = await page.textContent('#scale');
  writeFileSync(join(work, 'live/report.html'), final);
  await page.waitForFunction(() => document.getElementById('live')?.hidden && document.body.dataset.ready, null, { timeout: 60000 });
  assert.equal(await page.getAttribute('body', 'data-view'), '5', 'the new view is not shown');
  assert.equal(await page.getAttribute('body', 'data-fruit'), '3');
  await pixels(page, []);
  assert.equal(await page.textContent('#scale'), scale, 'the camera has moved');
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
for (const name of ['three', 'none', 'why'])
  await reading(name, wide, async (page) => {
    assert.ok(await page.isVisible('#no-fruit'));
    assert.ok(await page.isHidden('#csv'));
    if (name === 'why') assert.equal(await page.textContent('#no-fruit'), 'No fruit was found: none of 2 bodies was accepted: 2 were too small.');
    assert.equal(await page.isVisible('#notice'), name === 'none');
  });
await reading('hostile', wide, async (page) => {
  assert.equal(await page.textContent('#scene'), hostile);
  assert.equal(await page.locator('img:visible').count(), 0);
  assert.ok((await page.textContent('#warnings')).includes('<img'));
  await page.click('#fruits tbody tr');
  assert.ok((await page.textContent('#detail')).includes('<img'));
  await page.click('#parameters summary');
  assert.ok((await page.textContent('#parameter-table')).includes(hostile));
});
await browser.close();
if (!existsSync(join(work, 'scan_1600.png'))) process.exit(1);
