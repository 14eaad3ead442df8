// SPDX-License-Identifier: BSD-3-Clause
// The report's data: JSON in the page, clouds as base64 of little-endian arrays.

const bytes = (text) => Uint8Array.from(atob(text || ''), (c) => c.charCodeAt(0)).buffer;

/** Text to numbers: [n, 3] positions (m, world), normals or null, labels, views (-1 = not known), [n, 3] measured colors or null. */
function cloud(raw) {
  const n = raw.count;
  const positions = new Float32Array(3 * n);
  const q = raw.step ? new Uint16Array(bytes(raw.positions)) : new Float32Array(bytes(raw.positions));
  for (let i = 0; i < 3 * n; ++i) positions[i] = raw.step ? raw.origin[i % 3] + raw.step[i % 3] * q[i] : q[i];
  const normals = raw.normals ? new Int8Array(bytes(raw.normals)) : null;
  const labels = raw.labels ? new Uint16Array(bytes(raw.labels)) : new Uint16Array(n);
  const views = raw.views ? new Int16Array(bytes(raw.views)) : new Int16Array(n).fill(-1);
  const colors = raw.colors ? new Uint8Array(bytes(raw.colors)) : null;
  return { n, total: raw.total, positions, normals, labels, views, colors, radius: raw.radius };
}

/** Where a fruit is (m, world): the center of its body, or the centroid of its points where none was fitted. */
export const place = (f) => f.position_world || f.center_world || f.centroid_world;

export function readData() {
  const data = JSON.parse(document.getElementById('data').textContent);
  for (const name of ['cloud', 'merged', 'frontier']) data[name] = cloud(data[name]);
  data.views.forEach((v, i) => Object.assign(v, { index: i, depth: data.depth && data.depth[i] }));
  for (const { view, reason } of data.run.discarded_views || []) if (data.views[view]) data.views[view].discarded = String(reason);
  data.frame = data.run.frame_id || 'world';
  data.byId = new Map(data.fruits.map((f) => [f.id, f]));
  return data;
}

/** An element with attributes and children; text is always text, never markup. */
export function el(name, attributes = {}, ...children) {
  const svg = ['svg', 'path', 'line', 'text', 'rect', 'circle', 'g', 'title'].includes(name);
  const node = svg ? document.createElementNS('http://www.w3.org/2000/svg', name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === 'style') for (const [k, v] of Object.entries(value)) node.style.setProperty(k, v);
    else if (key.startsWith('on')) node.addEventListener(key.slice(2), value);
    else if (value !== undefined && value !== null) node.setAttribute(key, value);
  }
  node.append(...children.filter((c) => c !== null && c !== undefined));
  return node;
}

const finite = (x) => typeof x === 'number' && Number.isFinite(x);
export const dash = '\u2013';
/** A number with fixed decimals, a real minus sign and spaces between thousands; a dash where there is none. */
export function fixed(x, decimals = 0) {
  if (!finite(x)) return dash;
  const [whole, part] = Math.abs(x).toFixed(decimals).split('.');
  const text = whole.replace(/\B(?=(\d{3})+$)/g, '\u2009') + (part ? '.' + part : '');
  return (x < 0 && Number(x.toFixed(decimals)) !== 0 ? '\u2212' : '') + text;
}
export const percent = (x) => (finite(x) ? fixed(100 * x) + '\u00a0%' : dash);
export const seconds = (s) => (!finite(s) ? dash : s >= 1 ? fixed(s, 2) + '\u00a0s' : fixed(1000 * s, s < 0.01 ? 1 : 0) + '\u00a0ms');
export const words = (name) => String(name).replace(/_/g, ' ');
/** A button that copies a text; it says whether that worked. */
export function copyButton(label, text) {
  const button = el('button', { type: 'button', class: 'small', onclick: async () => {
    let done = false;
    try {
      await navigator.clipboard.writeText(text());
      done = true;
    } catch {  // a browser without a clipboard for pages from the disk
      const area = el('textarea', { style: { position: 'fixed', opacity: '0' } });
      area.value = text();
      document.body.append(area);
      area.select();
      done = document.execCommand('copy');
      area.remove();
      button.focus();
    }
    button.textContent = done ? 'Copied' : 'Not copied';
    setTimeout(() => (button.textContent = label), 1500);
  } }, label);
  return button;
}

/** Give the reader a file. */
export function save(name, type, text) {
  const url = URL.createObjectURL(new Blob([text], { type }));
  el('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}
export const plural = (n, one, many) => `${fixed(n)} ${n === 1 ? one : many}`;
