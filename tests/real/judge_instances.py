#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Judge a result of `agrisee process` against a labelled cloud: which labelled fruit were found, and how large.

usage: judge_instances.py LABELLED.ply FRUITS.csv RESULT_FOLDER

A labelled point goes to the result's point nearest to it, at most 6 mm away, and takes its instance. A fruit counts as found
when the instance with most of its points holds at least a third of them (labels are image masks, with flying pixels far
behind the fruit) and is not mostly another labelled fruit. The diameter of the found body is that of the sphere of its
volume; the true one cbrt(diameter^2 height) from the callipers. Plastic spheres (labels BALL...), which hang in the trees
to check the camera, count as fruit to be found, but their diameters are summed up apart. Needs Python alone.
"""
import collections
import csv
import json
import pathlib
import struct
import sys

REACH = 0.006
TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}


def read_ply(path):
    """Points (x, y, z, instance) of a binary little endian PLY file with one element."""
    data = pathlib.Path(path).read_bytes()
    head, body = data.split(b"end_header\n", 1)
    lines = [line.split() for line in head.decode().splitlines()]
    if ["format", "binary_little_endian", "1.0"] not in lines:
        sys.exit(f"{path}: is not a binary little endian PLY file")
    count = next(int(w[2]) for w in lines if w[:1] == ["element"])
    names = [w[2] for w in lines if w[:1] == ["property"]]
    record = struct.Struct("<" + "".join(TYPES[w[1]] for w in lines if w[:1] == ["property"]))
    columns = [names.index(name) for name in ("x", "y", "z", "instance")]
    return [tuple(row[c] for c in columns) for row in record.iter_unpack(body[: count * record.size])]


def clearly_visible(row):
    """Whether the mask of a labelled fruit covers at least 0.7 of the ellipse of its callipers."""
    mask = float(row["mask_equiv_diameter_mm"])
    diameter = float(row["caliper_diameter_mm"] or mask)
    return mask * mask >= 0.7 * diameter * float(row["caliper_height_mm"] or diameter)


class Judgement:
    """What became of the labelled fruit: a line of text for each, and the sums."""

    def __init__(self):
        self.lines, self.visible, self.found, self.fruits, self.others = [], [], 0, 0, 0
        self.errors = {"fruit": [], "spheres": []}  # of diameters, mm

    def summary(self):
        sizes = ", ".join(f"of {name} {sum(map(abs, e)) / len(e):.1f} mm in the mean (signed {sum(e) / len(e):+.1f}, {len(e)})"
                          for name, e in self.errors.items() if e)
        return (f"found {self.found} of {self.fruits}, {sum(self.visible)} of {len(self.visible)} clearly visible; "
                f"diameter error {sizes or 'unknown'}; {self.others} bodies that are no labelled fruit")


def judge(points, callipers, folder):
    """Judge a result folder by labelled points (x, y, z, label) and the rows of FRUITS.csv."""
    cells = collections.defaultdict(list)
    for p in read_ply(folder / "cloud.ply"):
        cells[tuple(int(c // REACH) for c in p[:3])].append(p)

    def instance_at(p):
        best, least = 0, REACH * REACH
        x, y, z = (int(c // REACH) for c in p[:3])
        for cell in ((x + i, y + j, z + k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)):
            for q in cells.get(cell, ()):
                d = (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2
                if d <= least:
                    best, least = q[3], d
        return best

    votes = collections.defaultdict(collections.Counter)  # label -> instance -> points
    claims = collections.defaultdict(collections.Counter)  # instance -> label -> points
    for p in points:
        if p[3] > 0:
            i = instance_at(p)
            votes[p[3]][i] += 1
            claims[i][p[3]] += 1
    fruits = json.loads((folder / "fruits.json").read_text())
    fruits = {f["id"]: f for f in (fruits["fruits"] if isinstance(fruits, dict) else fruits)}
    out, found = Judgement(), set()
    for row in callipers:
        label = int(row["instance"])
        count = sum(votes[label].values())
        named = [(n, i) for i, n in votes[label].items() if i > 0]
        n, i = max(named, default=(0, 0))
        clear = clearly_visible(row)
        text = f"{row['label']:10} {count:6}  {'visible' if clear else 'hidden '}"
        if i == 0 or 3 * n < count or claims[i].most_common(1)[0][0] != label:
            out.lines.append(f"{text}  missed")
            out.visible += [False] * clear
            continue
        found.add(i)
        out.visible += [True] * clear
        a, b, c = fruits[i]["radii"]
        size = 2e3 * (a * b * c) ** (1 / 3)
        text += f"  {100 * n // count:3} %"
        if row["caliper_diameter_mm"]:
            true = (float(row["caliper_diameter_mm"]) ** 2 * float(row["caliper_height_mm"])) ** (1 / 3)
            out.errors["spheres" if row["label"].startswith("BALL") else "fruit"].append(size - true)
            out.lines.append(f"{text}  {true:24.1f}  {size:5.1f}  {size - true:+5.1f}")
        else:
            out.lines.append(f"{text}  {'-':>24}  {size:5.1f}")
    out.found, out.fruits, out.others = len(found), len(callipers), len(fruits) - len(found)
    return out


def main():
    labelled, callipers, folder = sys.argv[1:4]
    result = judge(read_ply(labelled), list(csv.DictReader(open(callipers))), pathlib.Path(folder))
    print("label      points  in sight share  diameter (mm): callipers  found  error")
    print("\n".join(result.lines))
    print(result.summary())


if __name__ == "__main__":
    main()
