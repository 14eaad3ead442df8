// SPDX-License-Identifier: BSD-3-Clause
// What the camera saw in the view shown: its depth image, and its color image where there is one.
import { el, fixed } from './data.js';

const kDepth = /^[A-Za-z0-9+/=]+$/, kColor = /^data:image\/(png|jpeg);base64,[A-Za-z0-9+/=]+$/;

/** The colors of 256 levels, from far (violet) to near (yellow); level 0 is no return. Viridis, as polynomials. */
const palette = Array.from({ length: 256 }, (_, i) => {
  const x = i / 255;
  const channel = (...c) => Math.round(255 * Math.min(1, Math.max(0, c.reduceRight((sum, k) => sum * x + k, 0))));
  return i ? [channel(0.277727, 0.105093, -0.330862, -4.63423, 6.22827, 4.776385, -5.435456),
    channel(0.005407, 1.404614, 0.214848, -5.799101, 14.179933, -13.745145, 4.645853),
    channel(0.3341, 1.38459, 0.095095, -19.332441, 56.690553, -65.353033, 26.312435), 255] : [0, 0, 0, 0];
});

/** The color of each level of an image: half by its depth, half by its rank among the pixels, so that each fruit has relief. */
function colorsOf(levels) {
  const count = new Uint32Array(256);
  for (const level of levels) ++count[level];
  const all = levels.length - count[0];
  let below = 0;
  return palette.map((_, i) => {
    if (!i) return palette[0];
    below += count[i];
    return palette[Math.max(1, Math.round(0.5 * i + (all ? (127.5 * below) / all : 0)))];
  });
}

/** The depth (m) of a level: levels 1 to 255 are linear in 1/z, from `far` to `near`. */
export const depthOf = (level, { near, far }) => (level ? 1 / (1 / far + ((level - 1) / 254) * (1 / near - 1 / far)) : NaN);

export function makeImages(data, nodes) {
  const any = data.views.some((v) => v.depth || v.color);
  nodes.section.hidden = !any;
  if (!any) return { show() {} };
  const canvas = el('canvas', { role: 'img', 'aria-label': 'Depth image of the view' }), photo = el('img', { alt: 'Color image of the view' }), text = el('p');
  nodes.images.append(canvas, photo, text);
  let levels = null, range = null, wanted = -1;
  const caption = (at) => {
    text.textContent = !levels ? 'No image of this view.' : !range.near ? 'The camera measured nothing.' : at !== undefined ? (at > 0 ? `${fixed(1000 * at)}\u00a0mm` : 'no return')
      : `Depth from ${fixed(1000 * range.near)} (yellow) to ${fixed(1000 * range.far)}\u00a0mm (violet); point at it for values.`;
  };

  function paint(image) {
    [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
    const context = canvas.getContext('2d', { willReadFrequently: true });
    context.drawImage(image, 0, 0);
    const pixels = context.getImageData(0, 0, canvas.width, canvas.height);
    levels = new Uint8Array(canvas.width * canvas.height);
    for (let i = 0; i < levels.length; ++i) levels[i] = pixels.data[4 * i];
    const colors = colorsOf(levels);
    for (let i = 0; i < levels.length; ++i) pixels.data.set(colors[levels[i]], 4 * i);
    context.putImageData(pixels, 0, 0);
  }
  canvas.addEventListener('pointermove', (e) => {
    if (!levels) return;
    const box = canvas.getBoundingClientRect();
    const u = Math.floor(((e.clientX - box.left) / box.width) * canvas.width), v = Math.floor(((e.clientY - box.top) / box.height) * canvas.height);
    if (u >= 0 && v >= 0 && u < canvas.width && v < canvas.height) caption(depthOf(levels[v * canvas.width + u], range) || 0);
  });
  canvas.addEventListener('pointerleave', () => caption());

  return {
    show({ view }) {
      const { depth, color } = data.views[view] || {};
      if (wanted === view) return;
      wanted = view;
      photo.hidden = !(typeof color === 'string' && kColor.test(color));
      if (!photo.hidden) photo.src = color;
      canvas.hidden = !(depth && kDepth.test(depth.png));
      levels = null;
      if (canvas.hidden) return caption();
      range = depth;
      const image = el('img', { src: 'data:image/png;base64,' + depth.png });
      image.decode().then(() => {
        if (wanted !== view) return;
        paint(image);
        canvas.dataset.view = view + 1;
        caption();
      }, () => { if (wanted === view) { canvas.hidden = true; caption(); } });
    },
  };
}
