// SPDX-License-Identifier: BSD-3-Clause
// Distances in the view: from one point of the cloud, or center of a fruit, to another.
import { Group } from 'three';
import { copyButton, el, fixed } from './data.js';
import { thickLines } from './scene.js';

const kColor = '#d0006f';
const mm = (x) => fixed(1000 * x, 1);

/** `changed` is called when the lines are to be drawn anew. */
export function makeMeasure(scene, frame, node, button, changed) {
  const lines = new Group();
  scene.add(lines);
  let on = false, ends = [];
  const name = (e) => (e.fruit ? `center of fruit ${e.fruit}` : 'point');

  function show(note) {
    for (const line of lines.children) { line.geometry.dispose(); line.material.dispose(); }
    lines.clear();
    button.setAttribute('aria-pressed', String(on));
    node.hidden = !on;
    if (on && ends.length === 2) {
      const [a, b] = ends.map((e) => e.at), d = b.clone().sub(a);
      for (const [color, width, order] of [[0xffffff, 5, 20], [kColor, 2.5, 21]]) {
        const line = thickLines([a, b], color, width, { depthTest: false });
        line.renderOrder = order;
        lines.add(line);
      }
      const text = `${mm(d.length())}\u00a0mm`, values = { frame, from: a.toArray(), to: b.toArray(), distance: d.length() };
      node.replaceChildren(el('b', {}, text), el('span', {}, `${name(ends[0])} to ${name(ends[1])}; x\u00a0${mm(d.x)}, y\u00a0${mm(d.y)}, z\u00a0${mm(d.z)}\u00a0mm`),
        copyButton('Copy', () => JSON.stringify(values)));
    } else if (on) {
      for (const e of ends) {
        const mark = thickLines([0, 1, 2].flatMap((k) => [-1, 1].map((s) => e.at.clone().setComponent(k, e.at.getComponent(k) + 0.004 * s))), kColor, 2.5, { depthTest: false });
        mark.renderOrder = 21;
        lines.add(mark);
      }
      node.replaceChildren(el('span', {}, note || (ends.length ? `From the ${name(ends[0])}: click the second point or number.` : 'Click a point, or the number of a fruit for its center.')));
    }
    changed();
  }
  const toggle = (wanted = !on) => { on = wanted; ends = []; show(); };
  button.addEventListener('click', () => toggle());
  document.addEventListener('keydown', (e) => { if (on && e.key === 'Escape') { toggle(false); button.focus(); } });

  return {
    get on() { return on; },
    /** Take a place: {at, fruit}, or null where a click met no point. */
    take(end) {
      if (ends.length === 2) ends = [];
      if (end) ends.push(end);
      show(end ? '' : 'There is no point here; click nearer to one.');
    },
  };
}
