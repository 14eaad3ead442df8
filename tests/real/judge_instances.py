#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Judge a result of `agrisee process` against a labelled cloud: which labelled fruit were found, and how large.

usage: judge_instances.py LABELLED.ply FRUITS.csv RESULT_FOLDER

A labelled point goes to the result's point nearest to it, at most 6 mm away, and takes its instance. A fruit counts as found
when the instance with most of its points holds at least a third of them (labels are image masks, with flying pixels far
behind the fruit) and is not mostly another labelled fruit. The diameter of the found body is that of the sphere of its
volume; the true one cbrt(diameter^2 height) from the callipers. Needs Python alone.
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


def main():
    labelled, callipers, folder = sys.argv[1:4]
    folder = pathlib.Path(folder)
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
    for p in read_ply(labelled):
        if p[3] > 0:
            i = instance_at(p)
            votes[p[3]][i] += 1
            claims[i][p[3]] += 1
    fruits = json.loads((folder / "fruits.json").read_text())
    fruits = {f["id"]: f for f in (fruits["fruits"] if isinstance(fruits, dict) else fruits)}
    errors, found, total, visible = [], set(), 0, []
    print("label      points  in sight share  diameter (mm): callipers  found  error")
    for row in csv.DictReader(open(callipers)):
        label, total = int(row["instance"]), total + 1
        points = sum(votes[label].values())
        named = [(n, i) for i, n in votes[label].items() if i > 0]
        n, i = max(named, default=(0, 0))
        clear = clearly_visible(row)
        text = f"{row['label']:10} {points:6}  {'visible' if clear else 'hidden '}"
        if i == 0 or 3 * n < points or claims[i].most_common(1)[0][0] != label:
            print(f"{text}  missed")
            visible += [False] * clear
            continue
        found.add(i)
        visible += [True] * clear
        a, b, c = fruits[i]["radii"]
        size = 2e3 * (a * b * c) ** (1 / 3)
        text += f"  {100 * n // points:3} %"
        if row["caliper_diameter_mm"]:
            true = (float(row["caliper_diameter_mm"]) ** 2 * float(row["caliper_height_mm"])) ** (1 / 3)
            errors.append(size - true)
            print(f"{text}  {true:24.1f}  {size:5.1f}  {size - true:+5.1f}")
        else:
            print(f"{text}  {'-':>24}  {size:5.1f}")
    mean = sum(map(abs, errors)) / max(1, len(errors))
    bias = sum(errors) / max(1, len(errors))
    print(f"found {len(found)} of {total}, {sum(visible)} of {len(visible)} clearly visible; "
          f"diameter error {mean:.1f} mm in the mean (signed {bias:+.1f}); "
          f"{len(fruits) - len(found)} bodies that are no labelled fruit")


if __name__ == "__main__":
    main()
