// SPDX-License-Identifier: BSD-3-Clause
// MCAP files by Foxglove's own libraries: what `agrisee scan --mcap` writes is read by them, and what their writer records
// as ROS 2 does is processed.
//   node mcap_test.mjs AGRISEE WORKDIR
// Ends with 77 where they are missing (`npm ci` in tests/mcap installs them).
import { spawnSync } from 'node:child_process';
import { copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { open } from 'node:fs/promises';
import { join, resolve } from 'node:path';
import { strict as assert } from 'node:assert';

let mcap, rosmsg, serialization;
try {
  mcap = await import('@mcap/core');
  rosmsg = await import('@foxglove/rosmsg');
  serialization = await import('@foxglove/rosmsg2-serialization');
} catch {
  console.log('SKIPPED: @mcap/core is not installed; run `npm ci` in tests/mcap');
  process.exit(77);
}
const [agrisee, work] = process.argv.slice(2).map((p) => resolve(p));
rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
process.chdir(work);
function run(code, ...args) {
  const done = spawnSync(agrisee, args, { encoding: 'utf8' });
  assert.equal(done.status, code, `${args.join(' ')}: ${done.status}\n${done.stderr}`);
  return done.stdout + done.stderr;
}
const few = ['--quiet', '--no-picture', '--no-report'];
const json = (path) => JSON.parse(readFileSync(path, 'utf8'));

class File {
  constructor(path) { this.bytes = readFileSync(path); }
  async size() { return BigInt(this.bytes.length); }
  async read(offset, length) { return new Uint8Array(this.bytes.subarray(Number(offset), Number(offset + length))); }
}

/** All messages of a file, by topic, taken apart by their schemas. */
async function messagesOf(path) {
  const reader = await mcap.McapIndexedReader.Initialize({ readable: new File(path) });
  const readers = new Map(), out = {};
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId), schema = reader.schemasById.get(channel.schemaId);
    if (!readers.has(schema.id)) {
      const text = new TextDecoder().decode(schema.data);
      if (schema.encoding === 'ros2msg') {
        const cdr = new serialization.MessageReader(rosmsg.parse(text, { ros2: true }));
        readers.set(schema.id, (data) => cdr.readMessage(data));
      } else {
        assert.equal(schema.encoding, 'jsonschema');
        const properties = JSON.parse(text).properties;
        readers.set(schema.id, (data) => {
          const value = JSON.parse(new TextDecoder().decode(data));
          assert.deepEqual(Object.keys(value).sort(), Object.keys(properties).sort());
          return value;
        });
      }
    }
    (out[channel.topic] ??= []).push({ time: message.logTime, schema: schema.name, value: readers.get(schema.id)(message.data) });
  }
  return { reader, topics: out };
}

// What we write.
run(0, 'make-truss', '--total', '3', '--hidden', '0', '--seed', '1', '-o', 't');
const scene = readFileSync('t/scene.yaml', 'utf8').replace(/width: *1024/, 'width: 512').replace(/height: *768/, 'height: 384');
writeFileSync('t/scene.yaml', scene);
const views = 6;
run(0, 'scan', 't', '-o', 'scan', '--noise', 'l515', '--max-views', String(views), '--mcap', 'scan.mcap', ...few);
run(1, 'scan', 't', 't/scene.yaml', '-o', 'list', '--mcap', 'x.mcap', ...few);
assert.match(run(1, 'scan', 't', '-o', 'again', '--noise', 'l515', '--mcap', 'scan.mcap', ...few), /scan.mcap exists already/);
const written = readFileSync('scan.mcap');
run(0, 'scan', '--resume', 'scan', '--mcap', 'resumed.mcap', ...few);
assert.deepEqual(readFileSync('resumed.mcap'), written);
const { reader, topics } = await messagesOf('scan.mcap');
assert.equal(reader.header.profile, 'ros2');
assert.equal(topics['/depth/image'].length, views);
assert.equal(topics['/depth/camera_info'].length, views);
assert.equal(topics['/joint_states'].length, views);
assert.equal(topics['/tf'].length, 2 * views);
assert.equal(reader.statistics.messageCount, BigInt(Object.values(topics).reduce((sum, list) => sum + list.length, 0)));
let indexed = 0;
for (const chunk of reader.chunkIndexes) indexed += chunk.messageIndexOffsets.size;
assert.ok(indexed > 0 && reader.chunkIndexes.length > 1);
const rows = readFileSync('scan/views.csv', 'utf8').trim().split('\n').map((line) => line.split(','));
const column = (name) => rows[0].indexOf(name);
topics['/depth/image'].forEach(({ value: image, time }, i) => {
  assert.deepEqual([image.width, image.height, image.encoding, image.step], [512, 384, '32FC1', 2048]);
  assert.equal(image.data.length, 512 * 384 * 4);
  const depth = new Float32Array(image.data.slice().buffer);
  assert.ok(depth.some((z) => z > 0.2 && z < 1), 'no depths');
  const pose = topics['/tf'].find((m) => m.time === time).value.transforms[0];
  assert.equal(pose.child_frame_id, image.header.frame_id);
  ['x', 'y', 'z'].forEach((axis) => {
    assert.ok(Math.abs(pose.transform.translation[axis] - Number(rows[i + 1][column(axis)])) < 1e-12);
  });
  ['x', 'y', 'z', 'w'].forEach((axis) => {
    assert.ok(Math.abs(Math.abs(pose.transform.rotation[axis]) - Math.abs(Number(rows[i + 1][column('q' + axis)]))) < 1e-9);
  });
  const { name, position } = topics['/joint_states'][i].value;
  assert.equal(name[0], 'shoulder_pan_joint');
  position.forEach((q, j) => assert.ok(Math.abs(q - Number(rows[i + 1][column(`q${j + 1}`)])) < 1e-12));
});
const cloud = topics['/cloud'][0].value;
assert.equal(cloud.width, json('scan/run.json').points.filtered);
assert.equal(cloud.data.length, cloud.width * cloud.point_step);
const fruits = json('scan/fruits.json'), entities = topics['/fruit'][0].value.entities;
assert.equal(topics['/fruit'][0].schema, 'foxglove.SceneUpdate');
assert.equal(entities.length, fruits.length);
entities.forEach((entity, i) => {
  const { position } = entity.spheres[0].pose;
  assert.deepEqual([position.x, position.y, position.z], fruits[i].position_world);
  assert.ok(Math.abs(entity.spheres[0].size.x - 2 * fruits[i].radii[0]) < 1e-12);
});

// What we write, processed: as the exported views.
run(0, 'process', 'scan.mcap', '-o', 'own', ...few);
run(0, 'export-views', 'scan', '-o', 'exported', '--npy');
run(0, 'process', 'exported', '-o', 'yaml', ...few);
function same(a, b, tolerance) {
  const [left, right] = [json(`${a}/fruits.json`), json(`${b}/fruits.json`)];
  assert.ok(left.length === right.length && left.length === 3, `${a}: ${left.length} fruit, ${b}: ${right.length}`);
  left.forEach((fruit, i) => fruit.position_world.forEach((x, k) => {
    assert.ok(Math.abs(x - right[i].position_world[k]) < tolerance, `${a}, ${b}: fruit ${i}`);
  }));
}
same('own', 'yaml', 1e-6);
assert.equal(json('own/run.json').views, views);

// A recording as `ros2 bag record -s mcap` makes it: other topics, depths in millimetres, thirty frames a second while the
// arm moves too, the hand-eye transform on /tf_static, another order of the channels, one message a chunk, an index or none.
const definitions = Object.fromEntries([...reader.schemasById.values()].map((s) => [s.name, new TextDecoder().decode(s.data)]));
class Buffer64 {
  constructor() { this.parts = []; this.length = 0n; }
  position() { return this.length; }
  async write(bytes) { this.parts.push(bytes.slice()); this.length += BigInt(bytes.byteLength); }
  bytes() { return Buffer.concat(this.parts); }
}
async function record(path, options, fill) {
  const out = new Buffer64();
  const writer = new mcap.McapWriter({ writable: out, ...options });
  await writer.start({ profile: 'ros2', library: 'test' });
  const channels = new Map();
  const put = async (topic, type, time, value) => {
    if (!channels.has(topic)) {
      const schemaId = await writer.registerSchema({ name: type, encoding: 'ros2msg', data: new TextEncoder().encode(definitions[type]) });
      const id = await writer.registerChannel({ topic, schemaId, messageEncoding: 'cdr', metadata: new Map() });
      channels.set(topic, { id, cdr: new serialization.MessageWriter(rosmsg.parse(definitions[type], { ros2: true })) });
    }
    const { id, cdr } = channels.get(topic);
    await writer.addMessage({ channelId: id, sequence: 0, logTime: time, publishTime: time, data: cdr.writeMessage(value) });
  };
  await fill(put);
  await writer.end();
  writeFileSync(path, out.bytes());
}
const stamp = (time) => ({ sec: Number(time / 1000000000n), nanosec: Number(time % 1000000000n) });
const header = (time, frame_id) => ({ stamp: stamp(time), frame_id });
// base_T_tool0 = base_T_optical * optical_T_tool0, where the tool is 30 mm behind the camera, along its axis.
function toolOf({ translation: t, rotation: q }) {
  const z = [2 * (q.x * q.z + q.w * q.y), 2 * (q.y * q.z - q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)];
  return { translation: { x: t.x - 0.03 * z[0], y: t.y - 0.03 * z[1], z: t.z - 0.03 * z[2] }, rotation: q };
}
async function bag(put) {
  const start = 1780000000000000000n, step = 33333333n;
  const transform = (frame, child, time, pose) => ({ transforms: [{ header: header(time, frame), child_frame_id: child, transform: pose }] });
  await put('/tf_static', 'tf2_msgs/msg/TFMessage', start,
    transform('tool0', 'camera_optical', 0n, { translation: { x: 0, y: 0, z: 0.03 }, rotation: { x: 0, y: 0, z: 0, w: 1 } }));
  let time = start;
  for (let i = 0; i < views; ++i) {
    const image = topics['/depth/image'][i].value, info = topics['/depth/camera_info'][i].value;
    const depth = new Float32Array(image.data.slice().buffer);
    const mm = new Uint16Array(depth.map((z) => Math.round(1000 * z)));
    const pose = topics['/tf'][2 * i + 1].value.transforms[0].transform;
    for (let frame = 0; frame < 12; ++frame, time += step) {
      const moving = frame < 5;  // the image is then that of another place: it must not be used
      const at = toolOf(pose);
      if (moving) at.translation.z += 0.05 * (5 - frame);
      await put('/tf', 'tf2_msgs/msg/TFMessage', time, transform('base_link', 'tool0', time, at));
      await put('/camera/depth/camera_info', 'sensor_msgs/msg/CameraInfo', time, { ...info, header: header(time, 'camera_optical') });
      await put('/camera/depth/image_rect_raw', 'sensor_msgs/msg/Image', time + 5000000n,
        { header: header(time, 'camera_optical'), height: 384, width: 512, encoding: '16UC1', is_bigendian: 0, step: 1024, data: new Uint8Array(mm.buffer) });
      await put('/camera/color/image_raw', 'sensor_msgs/msg/Image', time,
        { header: header(time, 'camera_optical'), height: 1, width: 1, encoding: 'rgb8', is_bigendian: 0, step: 3, data: new Uint8Array(3) });
    }
  }
}
await record('bag.mcap', { chunkSize: 100000 }, bag);
await record('plain.mcap', { useChunks: false, useSummaryOffsets: false, useStatistics: false }, bag);
for (const name of ['bag', 'plain']) {
  run(0, 'process', `${name}.mcap`, '-o', name, ...few);
  assert.equal(json(`${name}/run.json`).views, views, `${name}: other views`);
  same(name, 'yaml', 2e-3);
}
run(0, 'process', 'bag.mcap', '-o', 'chosen', '--topic', '/camera/depth/image_rect_raw', '--world-frame', 'base_link', ...few);
assert.deepEqual(json('chosen/fruits.json'), json('bag/fruits.json'));
assert.match(run(2, 'process', 'bag.mcap', '-o', 'x', '--topic', '/camera/depth/image_rect_ra', ...few), /did you mean '\/camera\/depth\/image_rect_raw'/);
assert.match(run(2, 'process', 'bag.mcap', '-o', 'x', '--world-frame', 'map', ...few), /no transform leads from 'map'/);
assert.match(run(2, 'process', 'bag.mcap', '-o', 'x', '--topic', '/camera/color/image_raw', ...few), /\/camera\/depth\/camera_info|camera_info|does not fit/);

// What is cut off counts up to its end; what is damaged is refused; what is compressed says how to go on.
const whole = readFileSync('plain.mcap');
writeFileSync('cut.mcap', whole.subarray(0, Math.floor(whole.length * 0.8)));
run(0, 'process', 'cut.mcap', '-o', 'cut', ...few);
assert.match(JSON.stringify(json('cut/run.json').warnings), /cut off/);
assert.ok(json('cut/run.json').views < views);
const damaged = Buffer.from(readFileSync('scan.mcap'));
damaged[100000] ^= 0x55;
writeFileSync('damaged.mcap', damaged);
assert.match(run(2, 'process', 'damaged.mcap', '-o', 'x', ...few), /damaged.mcap: is damaged: the checksum/);
writeFileSync('text.mcap', 'no recording');
assert.match(run(2, 'process', 'text.mcap', '-o', 'x', ...few), /is not an MCAP file/);
await record('zipped.mcap', { chunkSize: 100000, compressChunk: (data) => ({ compression: 'zstd', compressedData: data }) }, bag);
assert.match(run(2, 'process', 'zipped.mcap', '-o', 'x', ...few), /compressed \('zstd'\).*--compression none/);
await record('still.mcap', {}, async (put) => {
  const image = topics['/depth/image'][0].value;
  await put('/depth/image', 'sensor_msgs/msg/Image', 1000000000n, { ...image, header: header(1000000000n, 'camera') });
  await put('/depth/camera_info', 'sensor_msgs/msg/CameraInfo', 1000000000n, topics['/depth/camera_info'][0].value);
});
assert.match(run(2, 'process', 'still.mcap', '-o', 'x', ...few), /no transform \(tf\) to the camera's frame 'camera'/);
// A lens that distorts is taken out; one of another model is refused; images that are said to be rectified stay as they are.
async function withLens(path, topic, distortion_model, d) {
  await record(path, {}, async (put) => {
    for (let i = 0; i < views; ++i) {
      const time = BigInt(i + 1) * 1000000000n;
      for (const m of topics['/tf'].slice(2 * i, 2 * i + 2)) await put('/tf', 'tf2_msgs/msg/TFMessage', m.time, m.value);
      await put(topic, 'sensor_msgs/msg/Image', time, topics['/depth/image'][i].value);
      await put('/depth/camera_info', 'sensor_msgs/msg/CameraInfo', time, { ...topics['/depth/camera_info'][i].value, distortion_model, d });
    }
  });
}
const fruitsOf = (name) => json(`${name}/fruits.json`).map((fruit) => fruit.position_world);
await withLens('pinhole.mcap', '/depth/image', 'plumb_bob', [0, 0, 0, 0, 0]);
await withLens('lens.mcap', '/depth/image', 'plumb_bob', [0.2, 0, 0, 0, 0]);
await withLens('rect.mcap', '/depth/image_rect', 'plumb_bob', [0.2, 0, 0, 0, 0]);
await withLens('fish.mcap', '/depth/image', 'equidistant', [0.2, 0, 0, 0]);
for (const name of ['pinhole', 'lens', 'rect']) run(0, 'process', `${name}.mcap`, '-o', name, ...few);
assert.deepEqual(fruitsOf('rect'), fruitsOf('pinhole'));
assert.notDeepEqual(fruitsOf('lens'), fruitsOf('pinhole'));
assert.match(run(2, 'process', 'fish.mcap', '-o', 'x', ...few), /the model 'equidistant', which is not supported/);
for (let i = 0; i < 50; ++i) {  // any byte may be wrong: an error or a result, never a crash
  const broken = Buffer.from(readFileSync('scan.mcap').subarray(0, 60000));
  broken[(i * 7919) % 3000] ^= 1 << i % 8;
  writeFileSync('broken.mcap', broken);
  const { status, signal } = spawnSync(agrisee, ['process', 'broken.mcap', '-o', 'broken', '--force', ...few]);
  assert.ok(signal === null && (status === 0 || status === 2), `byte ${(i * 7919) % 3000}: ${status} ${signal}`);
}
