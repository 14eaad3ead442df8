// SPDX-License-Identifier: BSD-3-Clause
// The report: one state, the view shown and the fruit chosen, that the 3D view, the tables and the curves follow.
import { makeCharts } from './charts.js';
import { el, fixed, plural, readData, save, seconds, words } from './data.js';
import { makeImages } from './images.js';
import { follow, recall } from './live.js';
import { makeStage } from './stage.js';
import { makeFruitTable, showParameters, showTiming, showWarnings } from './tables.js';
import { makeTheme } from './theme.js';

const $ = (id) => document.getElementById(id);
const data = readData();
const n = data.views.length, run = data.run;
const state = { view: n - 1, fruit: 0 };
let parts = [], stage = null;

function update() {
  document.body.dataset.view = state.view + 1;
  document.body.dataset.fruit = state.fruit;
  for (const part of parts) part.show(state);
}
const on = {
  state: () => state,
  view(k) { state.view = Math.min(n - 1, Math.max(0, k)); update(); },
  fruit(id) { state.fruit = id; update(); if (id) table.reveal(id); },
  left() {},
};

// What it is a report of.
const name = run.scene || 'Scan';
document.title = `${name} \u2013 AgriSEE`;
$('scene').textContent = name;
const sensor = run.noise && run.noise !== 'none' ? `noise ${run.noise}` : '';
$('made').textContent = ['AgriSEE ' + run.version, `preset ${run.preset}`, n ? `planner ${run.planner}` : '', n ? sensor : '', n ? `seed ${run.seed}` : '', run.time].filter(Boolean).map((t) => String(t).replace(/ /g, '\u00a0')).join(' \u00b7 ');
const reachable = data.fruits.filter((f) => f.reachable).length;
const facts = [[fixed(data.fruits.length), 'fruit'], [fixed(run.points.filtered), 'points'], [seconds(run.seconds.total), 'of computing']];
const discarded = data.views.filter((v) => v.discarded);
if (discarded.length) facts.splice(1, 0, [fixed(discarded.length), 'discarded']);
if (n) facts.splice(1, 0, [fixed(n), n === 1 ? 'view' : 'views']);
if (data.fruits.some((f) => f.picking_order !== undefined)) facts.splice(1, 0, [fixed(reachable), 'within reach']);
if (run.stop_reason !== 'not_stopped') facts.push([run.stop_reason === 'max_views' ? 'view budget' : words(run.stop_reason), 'ended the scan']);
$('summary').append(...facts.map(([value, what]) => el('div', {}, el('dt', {}, what), el('dd', {}, value))));

const table = makeFruitTable(data, { table: $('fruits'), none: $('no-fruit'), detail: $('detail') }, on);
parts.push(table, makeCharts(data, { section: $('curves-section'), curves: $('curves') }, on), makeImages(data, { section: $('images-section'), images: $('images') }));
showWarnings(data, { warnings: $('warnings'), none: $('no-fruit') });
if (data.fruits_csv) {
  $('csv').hidden = !data.fruits.length;
  $('csv').addEventListener('click', () => save(`${name.replace(/[^\w.-]+/g, '_')}_fruits.csv`, 'text/csv', data.fruits_csv));
}
showTiming(data, $('timing'));
showParameters(data, $('parameter-table'), $('filter'));

// The replay.
const slider = $('slider'), play = $('play');
let timer = 0;
function stop() { clearInterval(timer); timer = 0; play.classList.remove('on'); play.setAttribute('aria-label', 'Replay the scan'); }
if (n > 1) {
  $('replay').hidden = false;
  slider.max = n;
  slider.addEventListener('input', () => { stop(); on.view(Number(slider.value) - 1); });
  play.addEventListener('click', () => {
    if (timer) return stop();
    if (state.view === n - 1) on.view(0);
    play.classList.add('on');
    play.setAttribute('aria-label', 'Pause');
    timer = setInterval(() => (state.view < n - 1 ? on.view(state.view + 1) : stop()), 900);
  });
}
parts.push({
  show({ view }) {
    const v = data.views[view];
    if (!v) return;
    slider.value = view + 1;
    $('view-text').textContent = `View ${view} (${view + 1} of ${n}) \u00b7 ${v.discarded ? 'discarded' : plural(v.points_new, 'new point', 'new points')} \u00b7 planned in ${seconds(v.plan_seconds)}`;
  },
});

// The third dimension, where there is WebGL.
const thinned = ['cloud', 'merged'].find((c) => data[c].n < data[c].total);
try {
  stage = makeStage(data, { canvas: $('canvas'), viewport: $('viewport'), labels: $('labels'), scale: $('scale'), triad: $('triad'),
    cameras: $('cameras'), layers: $('layers'), measure: $('measure'), measured: $('measured') }, on);
  parts.push(stage);
  const cameras = [['scene', 'Scene'], ['fruit', 'Fruit'], ['top', 'Top'], ...(n ? [['sensor', 'Sensor']] : [])];
  $('views').append(...cameras.map(([key, label]) => el('button', { type: 'button', 'data-camera': key, onclick: () => stage.look(key) }, label)));
  for (const [key, layer] of Object.entries(stage.layers)) {
    const box = el('input', { type: 'checkbox', 'data-layer': key, onchange: () => stage.setLayer(key, box.checked) });
    box.checked = layer.on;
    const many = ['fruit', 'rest', 'measured', 'merged', 'frontier'].includes(key) ? fixed(layer.count) : '';
    $('layer-list').append(el('label', {}, box, layer.label, el('small', {}, many)));
  }
  if (!data.cloud.n) Object.assign($('notice'), { hidden: false, textContent: 'No points.' });
  if (thinned) $('layer-list').append(el('p', {}, `1 of ${Math.round(data[thinned].total / data[thinned].n)} points is shown.`));
} catch (error) {
  for (const id of ['cameras', 'layers', 'scale', 'triad']) $(id).hidden = true;
  Object.assign($('notice'), { hidden: false, textContent: 'This browser offers no WebGL, so the cloud cannot be drawn; the tables are complete.' });
  console.warn(String(error));
}
makeTheme($('theme'), (dark) => stage && stage.setDark(dark));

// While the scan runs, the next page takes the place of this one, and looks alike.
const kept = recall();
if (kept) {
  if (kept.view < kept.of - 1) state.view = Math.min(n - 1, kept.view);
  if (data.byId.has(kept.fruit)) state.fruit = kept.fruit;
  if (stage) {
    stage.restore(kept.pose);
    for (const box of $('layer-list').querySelectorAll('input')) {
      const shown = kept.layers[box.dataset.layer];
      if (shown !== undefined && shown !== box.checked) box.click();
    }
  }
  $('layers').open = kept.open;
}
if (data.running)
  follow($('live'), () => (timer || (stage && stage.busy) ? null : { view: state.view, of: n, fruit: state.fruit, pose: stage && stage.pose(),
    layers: Object.fromEntries(Object.entries(stage ? stage.layers : {}).map(([name, layer]) => [name, layer.on])), open: $('layers').open, scrolled: $('aside').scrollTop }));
update();
if (kept) $('aside').scrollTop = kept.scrolled;
document.body.dataset.ready = 'true';
