// SPDX-License-Identifier: BSD-3-Clause
// What stands in the three-dimensional view, as named layers. World frame, metres, z up.
import {
  AmbientLight, BoxGeometry, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DirectionalLight, DoubleSide, EdgesGeometry,
  FrontSide, Group, InstancedBufferAttribute, InstancedBufferGeometry, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, Quaternion, Scene, ShaderMaterial, SphereGeometry, Vector3,
} from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { place } from './data.js';

const kRest = '#989e96', kAxes = ['#db2626', '#219e38', '#2454db'], kFirst = '#1a2466', kLast = '#5ca8ed', kTool = '#8a4fbe', kDiscarded = '#c0392b';
const vec = (a) => new Vector3(a[0], a[1], a[2]);
const quat = (q) => new Quaternion(q[0], q[1], q[2], q[3]);

const surfelVertex = `
uniform float radius, pixel, selected, view, last;
uniform vec3 ground;
uniform bool facing;
attribute vec3 offset, direction;
attribute vec3 tint;
attribute float label, seen;
varying vec2 corner;
varying vec3 shaded;
void main() {
  corner = position.xy;
  vec4 middle = modelViewMatrix * vec4(offset, 1.0);
  vec3 n = normalize(normalMatrix * direction), toEye = normalize(-middle.xyz);
  bool flat_ = facing || dot(direction, direction) < 0.25;
  if (flat_) n = toEye;
  vec3 u = normalize(cross(n, abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0))), v = cross(n, u);
  gl_Position = projectionMatrix * (middle + vec4(max(radius, -1.1 * pixel * middle.z) * (corner.x * u + corner.y * v), 0.0));
  if (seen > view) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  float light = max(dot(n, normalize(vec3(-0.25, 0.45, 1.0))), 0.0);
  float away = dot(n, toEye);
  shaded = tint * (flat_ ? 0.95 : 0.58 + 0.44 * light);
  if (away < 0.0) shaded = mix(shaded, vec3(0.62), 0.45) * 0.85;
  // While a scan is replayed, what the present view added stands out; beside a selected fruit the rest steps back.
  if (view < last && seen >= 0.0 && seen < view) shaded = mix(shaded, ground, 0.45);
  if (selected > 0.0 && abs(label - selected) > 0.5) shaded = mix(shaded, ground, 0.72);
}`;
const surfelFragment = `
varying vec2 corner;
varying vec3 shaded;
void main() {
  if (dot(corner, corner) > 1.0) discard;
  gl_FragColor = vec4(shaded, 1.0);
}`;

/** Surface elements: discs along the normals, or facing the eye where there are none. `keep(i)` selects points. */
function surfels(cloud, keep, colorOf) {
  const index = [];
  for (let i = 0; i < cloud.n; ++i) if (keep(i)) index.push(i);
  const n = index.length, offset = new Float32Array(3 * n), direction = new Int8Array(3 * n), tint = new Uint8Array(3 * n);
  const label = new Float32Array(n), seen = new Float32Array(n);
  index.forEach((i, k) => {
    for (let a = 0; a < 3; ++a) offset[3 * k + a] = cloud.positions[3 * i + a];
    if (cloud.normals) for (let a = 0; a < 3; ++a) direction[3 * k + a] = cloud.normals[3 * i + a];
    tint.set(colorOf(i), 3 * k);
    label[k] = cloud.labels[i];
    seen[k] = cloud.views[i];
  });
  const geometry = new InstancedBufferGeometry();
  geometry.instanceCount = n;
  geometry.setAttribute('position', new BufferAttribute(new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  geometry.setAttribute('offset', new InstancedBufferAttribute(offset, 3));
  geometry.setAttribute('direction', new InstancedBufferAttribute(direction, 3, true));
  geometry.setAttribute('tint', new InstancedBufferAttribute(tint, 3, true));
  geometry.setAttribute('label', new InstancedBufferAttribute(label, 1));
  geometry.setAttribute('seen', new InstancedBufferAttribute(seen, 1));
  const material = new ShaderMaterial({
    uniforms: { radius: { value: cloud.radius }, pixel: { value: 0 }, selected: { value: 0 }, view: { value: 1e9 }, last: { value: 0 }, facing: { value: !cloud.normals }, ground: { value: new Color() } },
    vertexShader: surfelVertex,
    fragmentShader: surfelFragment, side: DoubleSide,
  });
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false;
  mesh.userData.count = n;
  return mesh;
}

const rgb = (hex) => { const c = parseInt(hex.slice(1), 16); return [c >> 16, (c >> 8) & 255, c & 255]; };
const mix = (a, b, t) => rgb(a).map((x, i) => Math.round(x + t * (rgb(b)[i] - x)));
/** The color of view i of n: the first dark, the last light. */
export const viewColor = (i, n) => mix(kFirst, kLast, n > 1 ? i / (n - 1) : 0);
const css = (c) => `rgb(${c[0]},${c[1]},${c[2]})`;

export function thickLines(points, color, width, extra = {}) {
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(points.flatMap((p) => [p.x, p.y, p.z]));
  const lines = new LineSegments2(geometry, new LineMaterial({ color: color ?? 0xffffff, linewidth: width, transparent: true, ...extra }));
  lines.frustumCulled = false;
  return lines;
}

/** A fitted body: almost clear, with a rim where it turns away from the eye. */
function body(fruit, color) {
  const material = new ShaderMaterial({
    uniforms: { color: { value: new Color().setStyle(color, '') }, strength: { value: 1 } },
    vertexShader: `varying vec3 n, e;
      void main() { vec4 p = modelViewMatrix * vec4(position, 1.0); n = normalMatrix * normal; e = -p.xyz; gl_Position = projectionMatrix * p; }`,
    fragmentShader: `uniform vec3 color; uniform float strength; varying vec3 n, e;
      void main() { float rim = 1.0 - abs(dot(normalize(n), normalize(e)));
        gl_FragColor = vec4(color * 0.72, strength * (0.05 + 0.75 * smoothstep(0.62, 0.95, rim))); }`,
    transparent: true, depthWrite: false, side: FrontSide,
  });
  const mesh = new Mesh(new SphereGeometry(1, 48, 32), material);
  mesh.scale.copy(vec(fruit.radii));
  mesh.quaternion.copy(quat(fruit.body_orientation_world));
  mesh.position.copy(vec(fruit.center_world));
  mesh.userData.id = fruit.id;
  mesh.renderOrder = 2;
  return mesh;
}

/** Three arrows' worth of axes, drawn over everything. */
function frame(position, orientation, length) {
  const group = new Group();
  const o = vec(position), q = quat(orientation);
  kAxes.forEach((color, i) => {
    const tip = new Vector3(i === 0, i === 1, i === 2).multiplyScalar(length).applyQuaternion(q).add(o);
    const under = thickLines([o, tip], 0xffffff, 4.5, { depthTest: false, opacity: 0.85 }), over = thickLines([o, tip], color, 2.2, { depthTest: false });
    under.renderOrder = 10;
    over.renderOrder = 11;
    group.add(under, over);
  });
  return group;
}

const corners = (view, rays, depth) => rays.map((r) => vec(r).multiplyScalar(depth).applyQuaternion(quat(view.rotation)).add(vec(view.position)));
function pyramid(view, rays, depth) {
  const o = vec(view.position), c = corners(view, rays, depth);
  return c.flatMap((p, i) => [o, p, p, c[(i + 1) % 4]]);
}

function cylinderBetween(mesh, a, b, radius) {
  const d = b.clone().sub(a);
  mesh.position.copy(a).addScaledVector(d, 0.5);
  mesh.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), d.clone().normalize());
  mesh.scale.set(radius, d.length(), radius);
}

/** The arm's links as a ghost: nearer ones hide farther ones, fruit shows through. */
function makeArm(radii) {
  const group = new Group(), shape = new CylinderGeometry(1, 1, 1, 40);
  const depth = new MeshBasicMaterial({ colorWrite: false });
  const paint = new MeshLambertMaterial({ color: '#aab4bf', transparent: true, opacity: 0.42, depthWrite: false });
  const sensor = new MeshLambertMaterial({ color: '#4a5663', transparent: true, opacity: 0.85, depthWrite: false });
  const links = radii.map((_, i) => {
    const solid = new Mesh(shape, depth), seen = new Mesh(shape, i === radii.length - 1 ? sensor : paint);
    solid.renderOrder = 4;
    seen.renderOrder = 5;
    seen.material.polygonOffset = true;
    seen.material.polygonOffsetFactor = -1;
    group.add(solid, seen);
    return [solid, seen];
  });
  return { group, pose: (segments) => segments.forEach((s, i) => links[i].forEach((m) => cylinderBetween(m, vec(s), vec(s.slice(3)), radii[i]))) };
}

function keepOut(spaces) {
  const group = new Group(), fill = new MeshBasicMaterial({ color: '#c0392b', transparent: true, opacity: 0.06, depthWrite: false, side: DoubleSide });
  const edge = new LineBasicMaterial({ color: '#c0392b', transparent: true, opacity: 0.35 });
  for (const s of spaces) {
    const shape = s.box ? new BoxGeometry(...s.box.size) : new CylinderGeometry(s.cylinder.radius, s.cylinder.radius, s.cylinder.height, 48).rotateX(Math.PI / 2);
    const mesh = new Mesh(shape, fill), lines = new LineSegments(new EdgesGeometry(shape, 30), edge);
    for (const m of [mesh, lines]) m.position.copy(vec((s.box || s.cylinder).center));
    mesh.renderOrder = 6;
    group.add(mesh, lines);
  }
  return group;
}

function approaches(fruits, standoff) {
  const group = new Group();
  for (const f of fruits) {
    if (!f.reachable || !f.pre_grasp_position_world || !f.radii) continue;
    const from = vec(f.pre_grasp_position_world), along = vec(f.approach_direction_world), to = vec(f.center_world).addScaledVector(along, -f.radii[2]);
    const side = along.clone().cross(Math.abs(along.z) < 0.9 ? new Vector3(0, 0, 1) : new Vector3(1, 0, 0)).normalize().multiplyScalar(0.006);
    const back = to.clone().addScaledVector(along, -0.014);
    const lines = thickLines([from, to, to, back.clone().add(side), to, back.clone().sub(side)], kTool, 2.5);
    lines.renderOrder = 7;
    lines.userData.id = f.id;
    group.add(lines);
  }
  return group;
}

/** The scene: `layers` by name ({node, label, count, on}), and what changes with the view shown and the fruit chosen. */
export function makeScene(data, resolution) {
  const scene = new Scene();
  const sun = new DirectionalLight(0xffffff, 2.0);
  scene.add(new AmbientLight(0xffffff, 1.7), sun, sun.target);
  const layers = {}, n = data.views.length, last = n - 1;
  const add = (name, label, node, count, on = true) => { if (count) { layers[name] = { label, node, count, on }; node.visible = on; scene.add(node); } return node; };

  const colors = new Map(Object.entries(data.colors).map(([id, c]) => [Number(id), rgb(c)])), rest = rgb(kRest);
  const fruitPoints = surfels(data.cloud, (i) => data.cloud.labels[i] > 0, (i) => colors.get(data.cloud.labels[i]) ?? rest);
  const restPoints = surfels(data.cloud, (i) => !data.cloud.labels[i], () => rest);
  const merged = surfels(data.merged, () => true, (i) => (data.merged.views[i] >= 0 ? viewColor(data.merged.views[i], n) : rest));
  const frontier = surfels(data.frontier, () => true, () => [230, 90, 20]);
  add('fruit', 'Fruit', fruitPoints, fruitPoints.userData.count);
  add('rest', 'Residual', restPoints, restPoints.userData.count);
  const measuredColor = (i) => data.cloud.colors.subarray(3 * i, 3 * i + 3);
  const measured = surfels(data.cloud, (i) => data.cloud.colors && measuredColor(i).some((c) => c > 0), measuredColor);
  add('measured', 'Measured colors', measured, measured.userData.count, false);
  add('merged', 'Merged cloud, by view', merged, merged.userData.count, false);
  add('frontier', 'Frontier', frontier, frontier.userData.count, false);
  const clouds = [fruitPoints, restPoints, measured, merged, frontier];

  const bodies = new Group(), frames = new Group(), fitted = data.fruits.filter((f) => f.radii && Math.min(...f.radii) > 0);
  fitted.forEach((f) => bodies.add(body(f, data.colors[f.id])));
  data.fruits.forEach((f) => { const g = frame(place(f), f.orientation_world, f.radii ? 0.85 * f.radii[0] : 0.03); g.userData.id = f.id; frames.add(g); });
  add('bodies', 'Fitted bodies', bodies, fitted.length);
  add('frames', 'Pose frames', frames, data.fruits.length);
  const reach = approaches(data.fruits);
  add('approaches', 'Picking approaches', reach, reach.children.length, false);

  const sensors = new Group(), small = [];
  const paths = [];
  data.views.forEach((v, i) => {
    const color = v.discarded ? kDiscarded : css(viewColor(i, n)), mark = thickLines(pyramid(v, data.sensor_rays, 0.03), color, 1.6);
    small.push(mark);
    sensors.add(mark);
    if (i > 0) {
      const path = thickLines([vec(data.views[i - 1].position), vec(v.position)], color, 1.3, { opacity: 0.55 });
      paths.push(path);
      sensors.add(path);
    } else paths.push(null);
  });
  add('sensors', 'Sensor and path', sensors, n);
  const sight = new Group();
  if (n) add('sight', 'Field of view', sight, n);

  const arm = makeArm(data.arm_radii);
  add('arm', 'Arm', arm.group, data.views.filter((v) => v.arm).length);
  if (data.scan_volume && n) {
    const { min, max } = data.scan_volume, size = max.map((x, a) => x - min[a]);
    const box = new LineSegments(new EdgesGeometry(new BoxGeometry(...size)), new LineBasicMaterial({ color: '#8a94a0', transparent: true, opacity: 0.6 }));
    box.position.copy(vec(min).add(vec(max)).multiplyScalar(0.5));
    add('volume', 'Scan volume', box, 1);
  }
  add('keep_out', 'Keep-out spaces', keepOut(data.keep_out), data.keep_out.length, false);

  function showView(k) {
    for (const c of clouds) Object.assign(c.material.uniforms.view, { value: n ? k : 1e9 }), (c.material.uniforms.last.value = last);
    data.views.forEach((v, i) => {
      small[i].material.opacity = i <= k ? 1 : 0.13;
      small[i].material.linewidth = i === k ? 3 : 1.6;
      if (paths[i]) paths[i].material.opacity = i <= k ? 0.55 : 0.08;
    });
    sight.clear();
    const v = data.views[k];
    if (!v) return;
    const depth = Math.max(vec(v.target).distanceTo(vec(v.position)), 0.05), color = css(viewColor(k, n));
    const lines = thickLines(pyramid(v, data.sensor_rays, depth), color, 1.1, { opacity: 0.5 });
    const c = corners(v, data.sensor_rays, depth), o = vec(v.position), sides = new BufferGeometry();
    sides.setFromPoints(c.flatMap((p, i) => [o, p, c[(i + 1) % 4]]));
    const faces = new Mesh(sides, new MeshBasicMaterial({ color, transparent: true, opacity: 0.05, depthWrite: false, side: DoubleSide }));
    faces.renderOrder = 6;
    sight.add(lines, faces);
    setResolution(resolution.width, resolution.height);
    if (layers.arm) { arm.group.visible = layers.arm.on && !!v.arm; if (v.arm) arm.pose(v.arm); }
  }

  function showFruit(id) {
    for (const c of [fruitPoints, restPoints]) c.material.uniforms.selected.value = id || 0;
    for (const b of bodies.children) b.material.uniforms.strength.value = !id ? 1 : b.userData.id === id ? 1.5 : 0.3;
    for (const f of frames.children) f.visible = !id || f.userData.id === id;
    for (const r of reach.children) r.visible = !id || r.userData.id === id;
  }

  /** How large a pixel is (m) at a distance of 1 m: no point is drawn smaller than it. */
  function setPixel(size) { for (const c of clouds) c.material.uniforms.pixel.value = size; }

  /** What steps back takes the color of the ground. */
  function setDark(dark) { for (const c of clouds) c.material.uniforms.ground.value.setStyle(dark ? '#2b3138' : '#e3e8ec', ''); }

  function setResolution(width, height) {
    resolution.width = width;
    resolution.height = height;
    scene.traverse((o) => { if (o.material && o.material.isLineMaterial) o.material.resolution.set(width, height); });
  }

  return { scene, sun, layers, fitted, showView, showFruit, setPixel, setResolution, setDark };
}
