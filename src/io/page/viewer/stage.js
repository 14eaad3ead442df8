// SPDX-License-Identifier: BSD-3-Clause
// The three-dimensional view: camera, labels, scale, picking. Frames are drawn only when something has changed.
import { PerspectiveCamera, Vector2, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { makeBadges } from './badges.js';
import { el, fixed, place } from './data.js';
import { makeMeasure } from './measure.js';
import { bodyOnRay, pointOnRay } from './pick.js';
import { makeScene } from './scene.js';

const kAxes = ['x', 'y', 'z'];
const vec = (a) => new Vector3(a[0], a[1], a[2]);

/** Which way "forward" and "up" are: as the robot sees it, or, without views, against the normals of the cloud. */
function directions(data) {
  const up = new Vector3(0, 0, 1), forward = new Vector3(0, 1, 0), v = data.scan_volume;
  if (data.views.length && v) {
    forward.copy(vec(v.min)).add(vec(v.max)).multiplyScalar(0.5).sub(vec(data.base)).setZ(0);
  } else if (data.cloud.normals) {
    const sum = new Vector3();
    for (let i = 0; i < 3 * data.cloud.n; i += 3) sum.add(vec(data.cloud.normals.subarray(i, i + 3)));
    sum.normalize();
    if (Math.abs(sum.z) > 0.8) {  // a sensor's own frame: z forward, y down
      forward.set(0, 0, sum.z < 0 ? 1 : -1);
      up.set(0, -1, 0);
    } else forward.set(-sum.x, -sum.y, 0);
  }
  if (forward.length() < 1e-6) forward.set(0, 1, 0);
  return { up, forward: forward.normalize(), side: forward.clone().cross(up).normalize() };
}

const boxCorners = (min, max) => Array.from({ length: 8 }, (_, i) => new Vector3(i & 1 ? max[0] : min[0], i & 2 ? max[1] : min[1], i & 4 ? max[2] : min[2]));

/** Corners of the middle 98 % of the points that `keep` selects; none without points. */
function extent(cloud, keep) {
  const box = [0, 1, 2].map((a) => {
    const values = [];
    for (let i = 0; i < cloud.n; ++i) if (keep(i)) values.push(cloud.positions[3 * i + a]);
    values.sort((x, y) => x - y);
    const cut = Math.floor(values.length / 100);
    return [values[cut], values[values.length - 1 - cut]];
  });
  return box[0][0] === undefined ? [] : boxCorners(box.map((b) => b[0]), box.map((b) => b[1]));
}

export function makeStage(data, nodes, on) {
  const renderer = new WebGLRenderer({ canvas: nodes.canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
  const world = makeScene(data, { width: 1, height: 1 });
  const camera = new PerspectiveCamera(36, 1, 0.005, 100);
  const axes = directions(data);
  camera.up.copy(axes.up);
  const controls = new OrbitControls(camera, nodes.canvas);
  Object.assign(controls, { enableDamping: false, zoomToCursor: true, rotateSpeed: 0.9 });

  const ofFruit = extent(data.cloud, (i) => data.cloud.labels[i] > 0);
  for (const f of world.fitted) if (Math.max(...f.radii) < 0.5)
    for (const s of [-1, 1]) ofFruit.push(...[0, 1, 2].map((a) => vec(f.center_world).setComponent(a, f.center_world[a] + s * f.radii[0])));
  const ofCloud = extent(data.cloud, () => true);
  const volume = data.scan_volume && data.views.length ? boxCorners(data.scan_volume.min, data.scan_volume.max) : [];
  const close = ofFruit.length ? ofFruit : ofCloud.length ? ofCloud : volume.length ? volume : boxCorners([-0.2, -0.2, -0.2], [0.2, 0.2, 0.2]);
  const wide = [...close, ...data.views.map((v) => vec(v.position))];
  const lastArm = data.views.length && data.views[data.views.length - 1].arm;
  if (lastArm) wide.push(vec(data.base), ...lastArm.map((s) => vec(s)));

  let pending = false, atView = null;
  const invalidate = () => { if (!pending) { pending = true; requestAnimationFrame(draw); } };

  /** Look along `direction` so that all points are in sight. */
  function lookAt(points, direction, up = axes.up, margin = 1.08) {
    atView = null;
    camera.fov = 36;
    camera.up.copy(up);
    const z = direction.clone().normalize(), x = z.clone().cross(up).normalize(), y = x.clone().cross(z);
    const ty = Math.tan((camera.fov * Math.PI) / 360) / margin, tx = ty * camera.aspect;
    const center = points.reduce((s, p) => s.add(p), new Vector3()).multiplyScalar(1 / points.length);
    let distance = 0.1;
    for (let round = 0; round < 4; ++round) {
      const q = points.map((p) => p.clone().sub(center)).map((p) => [p.dot(x), p.dot(y), p.dot(z)]);
      distance = Math.max(0.1, ...q.map(([a, b, c]) => Math.max(Math.abs(a) / tx, Math.abs(b) / ty) - c));
      const on = (i) => q.map((p) => p[i] / (distance + p[2]));
      const middle = (v) => 0.5 * distance * (Math.min(...v) + Math.max(...v));
      center.addScaledVector(x, middle(on(0))).addScaledVector(y, middle(on(1)));
    }
    camera.position.copy(center).addScaledVector(z, -distance);
    controls.target.copy(center);
    controls.update();
    invalidate();
  }

  const { forward, side, up } = axes;
  const direction = (f, s, u) => new Vector3().addScaledVector(forward, f).addScaledVector(side, s).addScaledVector(up, u);
  const cameras = {
    scene: () => lookAt(data.views.length ? wide : close, data.views.length ? direction(0.42, -0.9, -0.3) : direction(1, -0.25, -0.12), up, 1.16),
    fruit: () => lookAt(close, direction(1, -0.12, -0.1), up, 1.25),
    top: () => lookAt(data.views.length ? wide : close, direction(0.001, 0, -1), forward, 1.15),
    sensor: () => {
      const v = data.views[on.state().view];
      if (!v) return;
      const at = (r) => { const [qx, qy, qz, qw] = v.rotation; return vec(r).applyQuaternion({ x: qx, y: qy, z: qz, w: qw }); };
      const rows = data.sensor_rays.map((r) => Math.abs(r[1])), columns = data.sensor_rays.map((r) => Math.abs(r[0]));
      const half = Math.max(Math.max(...rows), Math.max(...columns) / camera.aspect);
      camera.fov = (Math.atan(half) * 360) / Math.PI;
      camera.up.copy(at([0, -1, 0]));
      camera.position.copy(vec(v.position));
      controls.target.copy(vec(v.target));
      camera.lookAt(controls.target);
      controls.update();
      atView = v;
      invalidate();
    },
  };
  let dragging = false;
  controls.addEventListener('change', invalidate);
  controls.addEventListener('end', () => (dragging = false));
  controls.addEventListener('start', () => { dragging = true; if (atView) { atView = null; on.left(); applyLayers(); } });

  // The arm and the sensor's own marks would stand before the eye of the sensor.
  function applyLayers() {
    for (const [name, layer] of Object.entries(world.layers)) layer.node.visible = layer.on && !(atView && ['arm', 'sensors', 'sight'].includes(name));
    const v = data.views[on.state().view];
    if (world.layers.arm && !(v && v.arm)) world.layers.arm.node.visible = false;
  }

  const size = new Vector2(1, 1), point = new Vector3();
  const toScreen = (p) => { point.copy(p).project(camera); return [(0.5 + 0.5 * point.x) * size.x, (0.5 - 0.5 * point.y) * size.y, point.z]; };

  const measure = makeMeasure(world.scene, data.frame, nodes.measured, nodes.measure, invalidate);
  const choose = (f) => (measure.on ? measure.take({ at: vec(place(f)), fruit: f.id }) : on.fruit(on.state().fruit === f.id ? 0 : f.id));
  const drawBadges = makeBadges(data, nodes.labels, place, { state: on.state, pick: choose });
  const controlsOnTop = [nodes.cameras, nodes.layers, nodes.measured, nodes.scale, nodes.triad];
  /** The parts of the view that controls and legends cover. */
  function covered() {
    const view = nodes.viewport.getBoundingClientRect();
    return controlsOnTop.filter((e) => !e.hidden).map((e) => e.getBoundingClientRect()).filter((b) => b.width > 0)
      .map((b) => ({ left: b.left - view.left, right: b.right - view.left, top: b.top - view.top, bottom: b.bottom - view.top }));
  }

  function drawScale() {
    const perMetre = size.y / (2 * Math.tan((camera.fov * Math.PI) / 360) * Math.max(camera.position.distanceTo(controls.target), 1e-3));
    let length = 1e-4;
    for (let d = 1e-4; d < 1e3; d *= 10) for (const k of [1, 2, 5]) if (k * d * perMetre < Math.min(0.22 * size.x, 160)) length = k * d;
    nodes.scale.style.width = `${(100 * length * perMetre) / size.x}%`;  // of the view, so that a print may have another size
    nodes.scale.firstElementChild.textContent = length >= 1 ? `${fixed(length)} m` : `${fixed(1000 * length, length < 1e-3 ? 1 : 0)} mm`;
    const x = new Vector3(), y = new Vector3();
    camera.matrixWorld.extractBasis(x, y, new Vector3());
    nodes.triad.replaceChildren(...kAxes.map((name, i) => {
      const a = 19 * x.getComponent(i), b = -19 * y.getComponent(i), long = Math.hypot(a, b), far = 1 + 8 / Math.max(long, 6);
      return el('g', { class: `axis ${name}` }, el('line', { x2: a, y2: b, 'stroke-width': 2, 'stroke-linecap': 'round' }),
        long > 5 ? el('text', { x: a * far, y: b * far, 'text-anchor': 'middle', 'dominant-baseline': 'central' }, name) : null);
    }));
  }

  function draw() {
    pending = false;
    camera.near = Math.max(camera.position.distanceTo(controls.target) / 300, 0.002);
    camera.far = camera.near * 20000;
    camera.updateProjectionMatrix();
    world.setPixel((2 * Math.tan((camera.fov * Math.PI) / 360)) / size.y);
    world.sun.position.copy(camera.position).addScaledVector(camera.up, 0.4 * camera.position.distanceTo(controls.target));
    world.sun.target.position.copy(controls.target);
    renderer.render(world.scene, camera);
    camera.updateMatrixWorld();
    drawScale();
    drawBadges(camera, toScreen, size, covered());
    nodes.canvas.dataset.frames = Number(nodes.canvas.dataset.frames || 0) + 1;
  }

  const rayAt = (px, py) => new Vector3((2 * px) / size.x - 1, 1 - (2 * py) / size.y, 0.5).unproject(camera).sub(camera.position).normalize();
  const slope = () => (5 * Math.tan((camera.fov * Math.PI) / 360)) / size.y;  // 2.5 pixels, at a distance of 1 m
  const isOn = (name) => world.layers[name] && world.layers[name].on;
  const { cloud, merged, frontier } = data;
  const inView = (c, i) => c.views[i] <= on.state().view;
  const shownOf = [[cloud, (i) => isOn(cloud.labels[i] > 0 ? 'fruit' : 'rest') && inView(cloud, i)],
    [merged, (i) => isOn('merged') && inView(merged, i)], [frontier, () => isOn('frontier')]];

  /** The fruit under a place of the canvas, 0 for none: the nearest of points shown and fitted bodies. */
  function fruitAt(px, py) {
    const ray = rayAt(px, py), hit = isOn('bodies') ? bodyOnRay(world.fitted, camera.position, ray) : null;
    const point = pointOnRay(cloud, shownOf[0][1], camera.position, ray, slope());
    const id = point && (!hit || point.distance < hit[1] - 0.002) ? cloud.labels[point.index] : hit ? hit[0] : 0;
    return data.byId.has(id) ? id : 0;
  }
  /** The point under a place of the canvas, of whichever cloud is on show. */
  function pointAt(px, py) {
    const ray = rayAt(px, py);
    return shownOf.map(([c, shown]) => c.n > 0 && pointOnRay(c, shown, camera.position, ray, slope())).filter(Boolean)
      .reduce((a, b) => (!a || b.distance < a.distance ? b : a), null);
  }
  let down = null;
  nodes.canvas.addEventListener('pointerdown', (e) => (down = [e.clientX, e.clientY]));
  nodes.canvas.addEventListener('click', (e) => {
    if (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) > 4) return;  // it was a drag
    const box = nodes.canvas.getBoundingClientRect();
    const place = [e.clientX - box.left, e.clientY - box.top];
    if (!measure.on) return on.fruit(fruitAt(...place));
    const point = pointAt(...place);
    measure.take(point && { at: point.at });
  });

  let first = true, restored = false;
  nodes.layers.addEventListener('toggle', invalidate);
  new ResizeObserver(() => {
    const box = nodes.viewport.getBoundingClientRect();
    if (box.width < 1 || box.height < 1) return;
    size.set(box.width, box.height);
    renderer.setSize(box.width, box.height, false);
    camera.aspect = box.width / box.height;
    camera.updateProjectionMatrix();
    world.setResolution(box.width, box.height);
    nodes.viewport.style.setProperty('--aspect', camera.aspect);
    if (first && !restored) cameras.scene();
    first = false;
    draw();
  }).observe(nodes.viewport);

  return {
    layers: world.layers,
    cameras,
    look(name) { cameras[name](); applyLayers(); invalidate(); },
    get busy() { return measure.on || dragging; },
    /** Where the camera is, and back there. */
    pose: () => ({ position: camera.position.toArray(), target: controls.target.toArray(), up: camera.up.toArray(), fov: camera.fov }),
    restore(pose) {
      restored = true;
      camera.position.fromArray(pose.position);
      controls.target.fromArray(pose.target);
      camera.up.fromArray(pose.up);
      camera.fov = pose.fov;
      controls.update();
      invalidate();
    },
    setDark(dark) { world.setDark(dark); invalidate(); },
    setLayer(name, shown) { world.layers[name].on = shown; applyLayers(); invalidate(); },
    show({ view, fruit }) {
      world.showView(view);
      world.showFruit(fruit);
      if (atView && atView.index !== view) cameras.sensor();
      applyLayers();
      invalidate();
    },
  };
}
