#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Judge `agrisee process --depth ... --masks ...` on a frame of real apples with masks, boxes and callipers.

usage: judge_masks.py DATA [--agrisee PROGRAM] [--with masks|boxes|both|color|none] [--spoil SPOIL]... [--seed N] [--out FOLDER]
                      [--params FILE] [--radius MIN,MAX] [--quiet]

--with color uses no detector, but the color prior with its defaults (--params FILE changes them).
DATA holds depth.png, color.png, labels.png and fruits.csv. SPOIL is one of
  shift:P      every mask is moved by P pixels in a random direction of eight
  erode:P      every mask loses P pixels all around
  merge        each two masks that touch or nearly touch become one
  missing:S    a share S of the masks is left out
  invented:S   masks are added where there is no label, S times as many as there are; each has the shape of a label
and may be given several times. A body is a label's if its center lies behind the label's middle, at most a radius to the
side; each body has at most one label. The diameter is twice the largest semi-axis, the true one the larger calliper
reading. "behind": bodies whose center is not 0 to 1.3 radii behind the middle depth of their label. With --radius "" the
program's default radii hold. Needs Python alone.
"""
import argparse
import collections
import csv
import json
import math
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import zlib

INTRINSICS = (1040.0, 1040.0, 959.5, 539.5)  # of the data set, see its README


def read_png(path):
    """(width, height, values) of a PNG file with one grey channel, not interlaced."""
    data, at, packed = pathlib.Path(path).read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, color = struct.unpack(">IIBB", body[:10])
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    if color != 0 or bits not in (8, 16):
        sys.exit(f"{path}: is not a grey PNG of 8 or 16 bits")
    step = bits // 8
    size, raw, above, out = width * step, zlib.decompress(packed), None, bytearray()
    above = bytearray(size)
    for y in range(height):
        kind, row = raw[y * (size + 1)], bytearray(raw[y * (size + 1) + 1 : (y + 1) * (size + 1)])
        for i in range(size if kind else 0):
            left = row[i - step] if i >= step else 0
            corner = above[i - step] if i >= step else 0
            if kind == 1:
                row[i] = (row[i] + left) & 255
            elif kind == 2:
                row[i] = (row[i] + above[i]) & 255
            elif kind == 3:
                row[i] = (row[i] + (left + above[i]) // 2) & 255
            else:
                guess = left + above[i] - corner
                a, b, c = abs(guess - left), abs(guess - above[i]), abs(guess - corner)
                row[i] = (row[i] + (left if a <= b and a <= c else above[i] if b <= c else corner)) & 255
        out += row
        above = row
    return width, height, list(out) if step == 1 else [v for (v,) in struct.iter_unpack(">H", bytes(out))]


def write_png8(path, width, height, values):
    """Write a grey PNG of 8 bits."""

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    rows = b"".join(b"\0" + bytes(values[y * width : (y + 1) * width]) for y in range(height))
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    pathlib.Path(path).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) +
                                   chunk(b"IEND", b""))


class Masks:
    """The masks of a frame as sets of pixels (u, v) by label, and how to spoil them."""

    def __init__(self, width, height, labels, depth, seed):
        self.width, self.height, self.depth = width, height, depth
        self.random = random.Random(seed)
        self.true = collections.defaultdict(set)
        for i, label in enumerate(labels):
            if label:
                self.true[label].add((i % width, i // width))
        self.masks = {label: set(pixels) for label, pixels in self.true.items()}
        self.missing, self.invented = [], []

    def inside(self, pixel):
        return 0 <= pixel[0] < self.width and 0 <= pixel[1] < self.height

    def shift(self, by):
        for label, pixels in self.masks.items():
            du, dv = self.random.choice([(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)])
            self.masks[label] = {p for p in ((u + by * du, v + by * dv) for u, v in pixels) if self.inside(p)}

    def erode(self, by):
        for _ in range(by):
            for label, pixels in self.masks.items():
                self.masks[label] = {(u, v) for u, v in pixels
                                     if {(u + 1, v), (u - 1, v), (u, v + 1), (u, v - 1)} <= pixels}

    def merge(self, _):
        near = {label: {(u + i, v + j) for u, v in pixels for i in (-2, 0, 2) for j in (-2, 0, 2)}
                for label, pixels in self.masks.items()}
        gone = set()
        for a in sorted(self.masks):
            for b in sorted(self.masks):
                if a < b and not {a, b} & gone and near[a] & near[b]:
                    self.masks[a] |= self.masks[b]
                    gone.add(b)
                    break
        for label in gone:
            del self.masks[label]

    def miss(self, share):
        self.missing = sorted(self.random.sample(sorted(self.masks), round(share * len(self.masks))))
        for label in self.missing:
            del self.masks[label]

    def invent(self, share):
        taken = {p for pixels in self.true.values() for p in pixels}
        shapes = [self.true[label] for label in sorted(self.true)]
        wanted, number = round(share * len(shapes)), max(self.true) + 1
        while len(self.invented) < wanted:
            du, dv = self.random.randint(-self.width, self.width), self.random.randint(-self.height, self.height)
            pixels = {(u + du, v + dv) for u, v in self.random.choice(shapes)}
            if not all(map(self.inside, pixels)) or pixels & taken:
                continue
            if 2 * sum(self.depth[v * self.width + u] > 0 for u, v in pixels) < len(pixels):
                continue
            self.masks[number] = pixels
            self.invented.append(number)
            taken |= pixels
            number += 1

    def spoil(self, how):
        name, _, value = how.partition(":")
        acts = {"shift": (self.shift, int), "erode": (self.erode, int), "merge": (self.merge, str),
                "missing": (self.miss, float), "invented": (self.invent, float)}
        if name not in acts:
            sys.exit(f"--spoil {how}: must be one of {', '.join(acts)}")
        act, kind = acts[name]
        act(kind(value))

    def image(self):
        out = [0] * (self.width * self.height)
        for label in sorted(self.masks, reverse=True):
            for u, v in self.masks[label]:
                out[v * self.width + u] = label
        return out


def middle(pixels):
    return sum(u for u, _ in pixels) / len(pixels), sum(v for _, v in pixels) / len(pixels)


def run(arguments, data, folder, masks, boxes):
    """Fruits and seconds of one call."""
    call = [arguments.agrisee, "process", "--depth", str(data / "depth.png"), "--intrinsics",
            ",".join(map(str, INTRINSICS)), "--depth-scale", "0.001", "-o", str(folder), "--force",
            "--no-report", "--no-picture", "--quiet", "--threads", "1"]
    call += ["--radius", arguments.radius] if arguments.radius else []
    call += ["--masks", str(masks)] if masks else []
    call += ["--boxes", str(boxes)] if boxes else []
    call += ["--color", str(data / "color.png")] if arguments.use == "color" else []
    call += ["--params", arguments.params] if arguments.params else []
    done = subprocess.run(call, capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    fruits = json.loads((folder / "fruits.json").read_text())
    return fruits, json.loads((folder / "run.json").read_text())["seconds"]["total"]


def match(fruits, masks, width, depth):
    """The fruit of each label, and the middle depth (m) of the label."""
    fx, fy, cx, cy = INTRINSICS
    pairs, depths = [], {}
    for label, pixels in sorted(masks.true.items()):
        values = sorted(depth[v * width + u] for u, v in pixels if depth[v * width + u])
        z = depths[label] = 1e-3 * values[len(values) // 2]
        u, v = middle(pixels)
        for fruit in fruits:
            x, y, far = fruit["center_world"]
            radius = sum(fruit["radii"]) / 3
            aside = math.hypot(x / far * z - (u - cx) / fx * z, y / far * z - (v - cy) / fy * z)
            if aside < radius and -radius < far - z < 2 * radius:
                pairs.append((aside / radius, label, fruit["id"]))
    found, used = {}, set()
    for _, label, number in sorted(pairs):
        if label not in found and number not in used:
            found[label] = number
            used.add(number)
    return found, depths


def main():
    parser = argparse.ArgumentParser(description="Judge masks on a real frame.")
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("--agrisee", default="agrisee")
    parser.add_argument("--with", dest="use", choices=["masks", "boxes", "both", "color", "none"], default="masks")
    parser.add_argument("--spoil", action="append", default=[])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--params")
    parser.add_argument("--radius", default="0.025,0.07")
    parser.add_argument("--quiet", action="store_true")
    arguments = parser.parse_args()
    folder = arguments.out or pathlib.Path(tempfile.mkdtemp(prefix="judge_masks_"))
    folder.mkdir(parents=True, exist_ok=True)
    width, height, depth = read_png(arguments.data / "depth.png")
    masks = Masks(width, height, read_png(arguments.data / "labels.png")[2], depth, arguments.seed)
    for how in arguments.spoil:
        masks.spoil(how)
    write_png8(folder / "masks.png", width, height, masks.image())
    if arguments.use == "color" and not arguments.params:
        arguments.params = str(folder / "prior.yaml")
        (folder / "prior.yaml").write_text("color_prior: {enabled: true}\n")
    fruits, seconds = run(arguments, arguments.data, folder / "result",
                          folder / "masks.png" if arguments.use in ("masks", "both") else None,
                          arguments.data / "fruits.csv" if arguments.use in ("boxes", "both") else None)
    found, depths = match(fruits, masks, width, depth)
    by_id = {f["id"]: f for f in fruits}
    rows = list(csv.DictReader(open(arguments.data / "fruits.csv")))
    errors, behind = {"NO": [], "YES": []}, 0
    for row in rows:
        label = int(row["label"])
        true = max(float(row["calliper_diameter_mm"]), float(row["calliper_height_mm"]))
        if label not in found:
            print(f"{label:4}  {true:6.1f} mm  missed{'  (no mask)' if label not in masks.masks else ''}")
            continue
        fruit = by_id[found[label]]
        size = 2e3 * max(fruit["radii"])
        back = (fruit["center_world"][2] - depths[label]) / (sum(fruit["radii"]) / 3)
        behind += not 0 <= back <= 1.3
        errors[row["occluded"]].append(size - true)
        if not arguments.quiet:
            print(f"{label:4}  {true:6.1f} mm  {size - true:+6.1f}  {'occluded' if row['occluded'] == 'YES' else 'visible ':8}"
                  f"  {fruit['found_by']:14}  confidence {fruit['confidence']:.2f}  center {back:+.2f} radii behind")

    def mean(values):
        return sum(map(abs, values)) / max(1, len(values))

    both = errors["NO"] + errors["YES"]
    visible = [int(row["label"]) for row in rows if row["occluded"] == "NO"]
    print(f"measured {len(found)} of {len(masks.true)}, {sum(v in found for v in visible)} of {len(visible)} visible; "
          f"diameter off by {mean(errors['NO']):.2f} mm visible, "
          f"{mean(errors['YES']):.2f} mm occluded, {mean(both):.2f} mm all (signed {sum(both) / max(1, len(both)):+.2f}); "
          f"{behind} behind; {len(fruits)} bodies, {len(fruits) - len(found)} without a label; {seconds:.2f} s")
    if masks.missing:
        bare = match(run(arguments, arguments.data, folder / "bare", None, None)[0], masks, width, depth)[0]
        print(f"missing masks {masks.missing}: {sum(m in found for m in masks.missing)} found, without any masks "
              f"{sum(m in bare for m in masks.missing)}")
    if masks.invented:
        fx, fy, cx, cy = INTRINSICS
        believed = []
        for number in masks.invented:
            u, v = middle(masks.masks[number])
            believed += [number for f in fruits if f["found_by"] == "mask" and math.hypot(
                f["center_world"][0] / f["center_world"][2] * fx + cx - u,
                f["center_world"][1] / f["center_world"][2] * fy + cy - v) < 20][:1]
        print(f"invented masks: {len(believed)} of {len(masks.invented)} believed")


if __name__ == "__main__":
    main()
