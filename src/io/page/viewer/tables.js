// SPDX-License-Identifier: BSD-3-Clause
// The tables beside the view: fruit and what is known of the one chosen, computing times, parameters.
import { copyButton, dash, el, fixed, percent, place, plural, seconds, words } from './data.js';

const mm = (x, decimals = 1) => fixed(1000 * x, decimals);
const list = (values, text) => (values ? values.map(text).join(',\u2002') : dash);
const error = (text, e, unit) => text + (e > 0 ? ` \u00b1 ${fixed(e, 1)}` : '') + '\u00a0' + unit;
const diameter = (f) => (f.radii ? 2 * Math.cbrt(f.radii[0] * f.radii[1] * f.radii[2]) : undefined);
const pose = (frame, position, orientation) => JSON.stringify({ frame, position, orientation });

/** How the picking order reads: its number, or why there is none. */
function picking(f) {
  if (f.picking_order === undefined) return [dash, 'not planned'];
  if (f.reachable || f.picking_reason === 'not_tested') return [String(f.picking_order), words(f.picking_reason)];
  return ['no', words(f.picking_reason)];
}

/** A ripeness in words: "pink (87 %), 45 +- 3 % has turned". */
const ripe = (r) => `${words(r.class)} (${percent(r.probability)}), ${fixed(100 * r.ripe_share)} \u00b1 ${fixed(100 * r.ripe_share_error)}\u00a0% has turned`;

export function makeFruitTable(data, nodes, on) {
  const bar = (share) => el('span', { class: 'bar' }, el('i', { style: { width: `${Math.round(100 * Math.min(1, Math.max(0, share)))}%` } }));
  const planned = data.fruits.some((f) => f.picking_order !== undefined);
  const colored = data.fruits.some((f) => f.ripeness);
  const trusses = new Set(data.fruits.map((f) => f.truss)).size > 1;
  const columns = [
    ['No.', (f) => f.id, (f) => [el('span', { class: 'dot', style: { background: data.colors[f.id] } }), String(f.id)], 'Number, from 1'],
    ...(trusses ? [['Truss', (f) => f.truss, (f) => [f.truss === undefined ? dash : String(f.truss)], 'Number of its truss']] : []),
    ...['x', 'y', 'z'].map((name, a) => [`${name}, mm`, (f) => place(f)[a], (f) => [mm(place(f)[a])], 'Center of the fitted body in world, or of the points where none was fitted']),
    ['\u2300, mm', diameter, (f) => [mm(diameter(f))], 'Diameter of the sphere of the same volume'],
    ['Seen', (f) => f.completeness, (f) => (f.completeness === undefined ? [dash] : [bar(f.completeness), percent(f.completeness)]), 'Completeness: share of the surface that was observed'],
    ['Conf.', (f) => f.confidence, (f) => [percent(f.confidence)], 'Confidence'],
    ['Mass, g', (f) => f.mass, (f) => [fixed(1000 * f.mass)], 'From the volume, with the density of the parameters'],
    ...(colored ? [['Ripeness', (f) => f.ripeness && f.ripeness.ripe_share, (f) => [f.ripeness ? words(f.ripeness.class) : dash], 'Class by the share of its surface that has turned']] : []),
    ...(planned ? [['Pick', (f) => f.picking_order, (f) => [picking(f)[0]], 'Picking order']] : []),
  ];
  nodes.table.hidden = !data.fruits.length;
  nodes.none.hidden = !!data.fruits.length;
  const rows = new Map(), body = el('tbody'), heads = [];
  let sorted = { column: 0, up: true };
  for (const f of data.fruits) {
    const choose = () => on.fruit(on.state().fruit === f.id ? 0 : f.id);
    const row = el('tr', { 'data-fruit': f.id, tabindex: 0, 'aria-selected': 'false', style: { '--c': data.colors[f.id] }, onclick: choose,
      onkeydown: (e) => { if (e.key === 'Enter' || e.key === ' ') { e.preventDefault(); choose(); } } });
    columns.forEach(([, , cells]) => row.append(el('td', {}, ...cells(f))));
    if (planned && picking(f)[0] === 'no') Object.assign(row.lastChild, { className: 'no', title: picking(f)[1] });
    rows.set(f.id, row);
  }
  function sort() {
    const value = (f) => { const v = columns[sorted.column][1](f); return v === undefined ? Infinity : v; };
    const order = [...data.fruits].sort((a, b) => { const u = value(a), v = value(b); return (u < v ? -1 : u > v ? 1 : a.id - b.id) * (sorted.up ? 1 : -1); });
    body.replaceChildren(...order.map((f) => rows.get(f.id)));
    heads.forEach((h, i) => (i === sorted.column ? h.setAttribute('aria-sort', sorted.up ? 'ascending' : 'descending') : h.removeAttribute('aria-sort')));
  }
  columns.forEach(([name, , , title], i) => heads.push(el('th', { scope: 'col', title }, el('button', { type: 'button', onclick: () => { sorted = { column: i, up: sorted.column === i ? !sorted.up : true }; sort(); } }, name))));
  nodes.table.append(el('thead', {}, el('tr', {}, ...heads)), body);
  sort();

  const ripeOfTruss = (id) => { const t = (data.run.trusses || []).find((truss) => truss.id === id); return t && t.ripeness ? ', ' + ripe(t.ripeness) : ''; };
  function detail(f) {
    const entries = [
      ['Position', list(place(f), (v) => mm(v)) + ` mm (${f.center_world ? 'center of the fitted body' : 'centroid: no body was fitted'})`],
      ['Orientation', list(f.orientation_world, (v) => fixed(v, 4)) + '\u2002(x\u00a0y\u00a0z\u00a0w)'],
      ['Found by', `${words(f.found_by)}, ${plural(f.points, 'point', 'points')}`],
      ...(f.truss === undefined ? [] : [['Truss', String(f.truss) + ripeOfTruss(f.truss)]]),
      ['Centroid, world', list(f.centroid_world, (v) => mm(v)) + ' mm'],
      ['Centroid, cluster', list(f.centroid_cluster, (v) => mm(v)) + ' mm'],
    ];
    if (f.radii) {
      const sigma = f.center_covariance_world && [0, 1, 2].map((a) => Math.sqrt(Math.max(0, f.center_covariance_world[a][a])));
      entries.push(['Standard error', list(sigma, (v) => mm(v, 2)) + ' mm'],
        ['Semi-axes', list(f.radii, (v) => mm(v)) + ' mm'], ['Body axes', list(f.body_orientation_world, (v) => fixed(v, 4)) + '\u2002(x\u00a0y\u00a0z\u00a0w)'],
        ['Fit', `${mm(f.rms, 2)} mm root mean square`], ['Volume', error(fixed(1e6 * f.volume, 1), 1e6 * f.volume_error, 'ml')],
        ['Mass', error(fixed(1000 * f.mass, 1), 1000 * f.mass_error, 'g')], ['Seen, confidence', `${percent(f.completeness)}, ${percent(f.confidence)}`]);
    }
    if (f.ripeness) entries.push(['Ripeness', ripe(f.ripeness)]);
    if (f.picking_order !== undefined) {
      const after = f.picking_after && f.picking_after.length ? `, after fruit ${f.picking_after.join(', ')}` : '';
      entries.push(['Picking', `number ${f.picking_order}${after}: ${picking(f)[1]}`]);
      if (f.pre_grasp_position_world)
        entries.push(['Approach', list(f.approach_direction_world, (v) => fixed(v, 3))], ['Pre-grasp position', list(f.pre_grasp_position_world, (v) => mm(v)) + ' mm'],
          ['Pre-grasp rotation', list(f.pre_grasp_orientation_world, (v) => fixed(v, 4)) + '\u2002(x\u00a0y\u00a0z\u00a0w)']);
      if (f.approach_crossed > 0) entries.push(['Approach crosses', `${fixed(1e4 * f.approach_crossed, 1)} cm\u00b2 of what is no fruit`]);
      if (f.pre_grasp_joints) entries.push(['Pre-grasp joints', list(f.pre_grasp_joints, (v) => fixed((v * 180) / Math.PI, 1)) + ' \u00b0']);
    }
    nodes.detail.style.setProperty('--c', data.colors[f.id]);
    nodes.detail.replaceChildren(el('h3', {}, `Fruit ${f.id}`, el('button', { type: 'button', 'aria-label': 'Close', onclick: () => on.fruit(0) }, '\u00d7')),
      el('p', { class: 'buttons' }, copyButton('Copy pose', () => pose(data.frame, place(f), f.orientation_world)),
        f.pre_grasp_position_world ? copyButton('Copy pre-grasp pose', () => pose(data.frame, f.pre_grasp_position_world, f.pre_grasp_orientation_world)) : null),
      el('dl', {}, ...entries.flatMap(([k, v]) => [el('dt', {}, k), el('dd', {}, v)])));
  }

  return {
    show({ fruit }) {
      for (const [id, row] of rows) row.setAttribute('aria-selected', String(id === fruit));
      const f = data.byId.get(fruit);
      nodes.detail.hidden = !f;
      if (f) detail(f);
    },
    reveal(fruit) { rows.get(fruit)?.scrollIntoView({ block: 'nearest' }); },
  };
}

const kReasons = { repeated_frame: 'the frame repeats the one before, so the camera hangs', contradicts_others: 'it contradicts what other views saw, so its pose is wrong' };

/** What the reader must know first: views that are not part of the result, and why there is no fruit. */
export function showWarnings(data, nodes) {
  const discarded = data.views.filter((v) => v.discarded), n = data.views.length;
  if (discarded.length) {
    const reasons = new Map();
    for (const v of discarded) reasons.set(v.discarded, [...(reasons.get(v.discarded) || []), v.index]);
    const list = [...reasons].map(([why, views]) => `${views.length > 1 ? 'views' : 'view'} ${views.join(', ')} (${kReasons[why] || words(why)})`);
    nodes.warnings.append(el('p', {}, `${discarded.length} of ${plural(n, 'view', 'views')} ${discarded.length === 1 ? 'was' : 'were'} discarded: ${list.join('; ')}.`));
  }
  for (const warning of data.run.warnings || []) nodes.warnings.append(el('p', {}, String(warning)));
  nodes.warnings.hidden = !nodes.warnings.childElementCount;
  nodes.none.textContent = data.running ? 'No fruit was found so far.' : data.run.no_fruit ? `No fruit was found: ${data.run.no_fruit}.` : 'No fruit was found.';
}

const kStages = { plan: '#2a6fb5', fuse: '#17a0a8', filter: '#2e9d55', normals: '#9bb024', segment: '#e8952c', locate: '#c8508f' };

export function showTiming(data, node) {
  const s = data.run.seconds, stages = Object.keys(kStages).filter((k) => s[k] > 0), sum = stages.reduce((t, k) => t + s[k], 0);
  node.append(el('div', { class: 'stack' }, ...stages.map((k) => el('i', { style: { background: kStages[k], width: `${(100 * s[k]) / sum}%` }, title: `${k}: ${seconds(s[k])}` }))),
    el('div', { class: 'key' }, ...stages.map((k) => el('span', {}, el('i', { style: { background: kStages[k] } }), `${k} `, el('b', {}, seconds(s[k]))))),
    el('p', {}, `${seconds(s.total)} of computing, ${plural(data.run.threads, 'thread', 'threads')}` + (s.capture > 0 ? `; the simulated sensor took ${seconds(s.capture)} besides.` : '.')));
}

export function showParameters(data, table, filter) {
  const flat = (value, prefix) => Object.entries(value).flatMap(([k, v]) => (v && typeof v === 'object' && !Array.isArray(v) ? flat(v, `${prefix}${k}.`) : [[prefix, k, v]]));
  const rows = flat({ seed: data.run.seed, noise: data.run.noise, ...data.run.parameters }, '').map(([prefix, key, value]) => {
    const row = el('tr', {}, el('td', {}, el('i', {}, prefix), key), el('td', {}, typeof value === 'string' ? value : JSON.stringify(value)));
    return [row, (prefix + key).toLowerCase()];
  });
  table.append(el('tbody', {}, ...rows.map(([row]) => row)));
  filter.addEventListener('input', () => { for (const [row, name] of rows) row.hidden = !name.includes(filter.value.trim().toLowerCase()); });
}
