// SPDX-License-Identifier: BSD-3-Clause
// What the views brought: shares of the fruit's surface, and new points. Drawn as SVG; a click chooses the view.
import { el, fixed, percent } from './data.js';

const kHeight = 132, kTop = 8, kBottom = 20, kLeft = 40, kRight = 8;
const kColors = ['var(--accent)', '#97a3af', '#2e9d55'];

export function makeCharts(data, nodes, on) {
  const n = data.views.length, curves = data.curves.filter((c) => c.values.some((v) => typeof v === 'number'));
  const added = data.views.map((v) => v.points_new);
  if (!n) return { show() {} };
  nodes.section.hidden = false;
  const keys = curves.map((c, i) => el('b', {}));
  const shares = el('svg', { height: kHeight, role: 'img', 'aria-label': 'Shares of the surface over the views' });
  const gain = el('svg', { height: kHeight, role: 'img', 'aria-label': 'New points a view' });
  const addedNow = el('b', {});
  const legend = (entries) => el('div', { class: 'key' }, ...entries);
  if (curves.length)
    nodes.curves.append(el('h3', {}, 'Share of the fruit\u2019s surface'),
      legend(curves.map((c, i) => el('span', {}, el('i', { style: { background: kColors[i % 3] } }), c.name + ' ', keys[i]))), shares);
  nodes.curves.append(el('h3', {}, 'New points a view ', addedNow), gain);

  let width = 0, view = n - 1;
  const x = (i) => kLeft + ((i + 0.5) / n) * (width - kLeft - kRight);
  const y = (share) => kTop + (1 - share) * (kHeight - kTop - kBottom);
  const nice = (max) => { const e = 10 ** Math.floor(Math.log10(max)); return [1, 2, 2.5, 5, 10].map((k) => k * e).find((k) => k >= max); };

  function axes(svg, ticks) {
    svg.setAttribute('viewBox', `0 0 ${width} ${kHeight}`);
    svg.replaceChildren(...ticks.map(([at, text]) => el('g', {}, el('line', { class: 'grid', x1: kLeft, x2: width - kRight, y1: y(at), y2: y(at) }),
      el('text', { x: kLeft - 6, y: y(at), 'text-anchor': 'end', 'dominant-baseline': 'central' }, text))));
    const step = Math.max(1, Math.ceil(n / Math.max(2, Math.floor((width - kLeft) / 34))));
    for (let i = 0; i < n; i += step) svg.append(el('text', { x: x(i), y: kHeight - 4, 'text-anchor': 'middle' }, String(i + 1)));
  }

  function draw() {
    const best = nice(Math.max(1, ...added));
    if (curves.length) {
      axes(shares, [[0, '0\u00a0%'], [0.5, '50\u00a0%'], [1, '100\u00a0%']]);
      shares.append(el('line', { class: 'now', x1: x(view), x2: x(view), y1: kTop, y2: kHeight - kBottom }));
      curves.forEach((c, k) => {
        let path = '', pen = 'M';
        c.values.forEach((v, i) => {
          if (typeof v !== 'number') return (pen = 'M');
          path += `${pen}${x(i).toFixed(1)},${y(v).toFixed(1)}`;
          pen = 'L';
        });
        shares.append(el('path', { d: path, fill: 'none', style: { stroke: kColors[k % 3] }, 'stroke-width': 2, 'stroke-linejoin': 'round' }));
        if (typeof c.values[view] === 'number') shares.append(el('circle', { cx: x(view), cy: y(c.values[view]), r: 3.5, style: { fill: kColors[k % 3] }, class: 'mark' }));
      });
    }
    axes(gain, [[0, '0'], [0.5, fixed(best / 2, best / 2 % 1 ? 1 : 0)], [1, fixed(best)]]);
    const bar = Math.max(1, Math.min(28, 0.66 * (width - kLeft - kRight) / n));
    added.forEach((v, i) => gain.append(el('rect', { x: x(i) - bar / 2, width: bar, y: y(v / best), height: Math.max(0, y(0) - y(v / best)), rx: 1.5,
      class: (i === view ? 'gain now' : i < view ? 'gain' : 'gain later') + (data.views[i].discarded ? ' discarded' : '') })));
  }
  for (const svg of [shares, gain])
    svg.addEventListener('click', (e) => {
      const box = svg.getBoundingClientRect(), i = Math.floor(((e.clientX - box.left - kLeft) / (box.width - kLeft - kRight)) * n);
      on.view(Math.min(n - 1, Math.max(0, i)));
    });
  new ResizeObserver(() => {
    width = nodes.curves.clientWidth;
    if (width > 0) draw();
  }).observe(nodes.curves);
  return {
    show(state) {
      view = state.view;
      curves.forEach((c, i) => (keys[i].textContent = percent(c.values[view])));
      addedNow.textContent = fixed(added[view]);
      if (width > 0) draw();
    },
  };
}
