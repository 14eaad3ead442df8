// SPDX-License-Identifier: BSD-3-Clause
// The numbers of the fruit beside their bodies. They cover neither one another nor the controls of the view.
import { Vector3 } from 'three';
import { el } from './data.js';

const kGap = 2, kRounds = 40;

/** How far (dx, dy) a disc must move to leave a rectangle by its nearest side; null where it does not touch it. */
function outOf(b, p, r) {
  const left = p.x - (b.left - r), right = b.right + r - p.x, up = p.y - (b.top - r), down = b.bottom + r - p.y;
  const least = Math.min(left, right, up, down);
  if (least <= 0.01) return null;
  return least === left ? [-left, 0] : least === right ? [right, 0] : least === up ? [0, -up] : [0, down];
}

/**
 * Places for discs, as near as possible to where they want to be ({x, y, r}, pixels), so that none covers another or a
 * rectangle of `taken`, and all are inside the view. First they push one another away, which moves little from frame to
 * frame; discs that still overlap go to the nearest free place on a spiral around where they want to be. Where there is
 * none, the disc is `lost`.
 */
export function apart(wanted, taken, width, height) {
  const at = wanted.map((p) => ({ ...p }));
  const keepInside = (p) => { p.x = Math.min(width - p.r, Math.max(p.r, p.x)); p.y = Math.min(height - p.r, Math.max(p.r, p.y)); };
  at.forEach(keepInside);
  for (let round = 0, moved = true; moved && round < kRounds; ++round) {
    moved = false;
    for (let i = 0; i < at.length; ++i)
      for (let k = i + 1; k < at.length; ++k) {
        const a = at[i], b = at[k], need = a.r + b.r + kGap;
        let dx = b.x - a.x, dy = b.y - a.y, distance = Math.hypot(dx, dy);
        if (distance >= need - 0.01) continue;
        if (distance < 1e-6) [dx, dy, distance] = [Math.cos(i + 2 * k), Math.sin(i + 2 * k), 1];
        const push = (need - Math.min(Math.hypot(b.x - a.x, b.y - a.y), need)) / 2 / distance;
        a.x -= push * dx; a.y -= push * dy; b.x += push * dx; b.y += push * dy;
        moved = true;
      }
    for (const p of at) {
      for (const b of taken) {
        const out = outOf(b, p, p.r + kGap);
        if (out) { p.x += out[0]; p.y += out[1]; moved = true; }
      }
      keepInside(p);
    }
  }
  const free = (p, others) => p.x >= p.r && p.y >= p.r && p.x <= width - p.r && p.y <= height - p.r && !taken.some((b) => outOf(b, p, p.r)) &&
    others.every((o) => Math.hypot(o.x - p.x, o.y - p.y) >= p.r + o.r - 0.02);
  const settled = [];
  at.forEach((p, i) => {
    for (let turn = 0; !free(p, settled) && !p.lost; ++turn) {
      const distance = 6 * Math.sqrt(turn), angle = 2.4 * turn;
      p.x = wanted[i].x + distance * Math.cos(angle);
      p.y = wanted[i].y + distance * Math.sin(angle);
      p.lost = turn > 900;
    }
    if (!p.lost) settled.push(p);
  });
  return at;
}

/** Badges of all fruit in `node`; `draw` puts them in place for the present camera. */
export function makeBadges(data, node, place, on) {
  const lines = el('svg', { preserveAspectRatio: 'none' });
  node.append(lines);
  const badges = data.fruits.map((f) => {
    const badge = el('b', { onclick: () => on.pick(f), 'data-fruit': f.id, style: { 'border-color': data.colors[f.id] } }, String(f.id));
    node.append(badge);
    return { f, badge, at: new Vector3(...place(f)), radius: f.radii ? f.radii[2] : 0, r: Math.max(11, 6.5 + 3.8 * String(f.id).length) };
  });

  /** `toScreen(p)`: pixels and depth of a point; `taken`: rectangles that stay free. */
  return function draw(camera, toScreen, size, taken) {
    const chosen = on.state().fruit, x = new Vector3(), y = new Vector3(), seen = [];
    camera.matrixWorld.extractBasis(x, y, new Vector3());
    for (const b of badges) {
      const [cx, cy, depth] = toScreen(b.at);
      const [wx, wy] = toScreen(b.at.clone().addScaledVector(x, -0.78 * b.radius).addScaledVector(y, 0.78 * b.radius));
      b.badge.dataset.x = cx.toFixed(1);
      b.badge.dataset.y = cy.toFixed(1);
      b.badge.hidden = !(depth < 1 && wx > 0 && wy > 0 && wx < size.x && wy < size.y);
      if (!b.badge.hidden) seen.push({ b, x: wx, y: wy, r: b.r });
    }
    const percent = (v, of) => `${((100 * v) / of).toFixed(3)}%`;  // so that a print may have another size
    lines.setAttribute('viewBox', `0 0 ${size.x} ${size.y}`);
    lines.replaceChildren();
    apart(seen, taken, size.x, size.y).forEach((p, i) => {
      const { f, badge } = p.b, wanted = seen[i];
      badge.hidden = !!p.lost;
      if (p.lost) return;
      badge.style.left = percent(p.x, size.x);
      badge.style.top = percent(p.y, size.y);
      badge.style.background = chosen === f.id ? data.colors[f.id] : '';
      badge.className = chosen === f.id ? 'on' : chosen ? 'off' : '';
      if (Math.hypot(p.x - wanted.x, p.y - wanted.y) > p.r)
        lines.append(el('line', { x1: p.x, y1: p.y, x2: wanted.x, y2: wanted.y, stroke: data.colors[f.id], 'stroke-width': 1.5, opacity: chosen && chosen !== f.id ? 0.35 : 0.9 }));
    });
  };
}
