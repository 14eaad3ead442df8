#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Judge `agrisee process` on variants of a labelled cloud: what is found by luck in one frame is not found in most of these.

usage: judge_variants.py LABELLED.ply FRUITS.csv [--agrisee PROGRAM] [--params FILE] [--seed N] [--out FOLDER]

The cloud, as its camera sees it from the origin, is mirrored, turned about the optical axis, thinned, scaled, or given more
noise along its sight lines. Each variant is judged as by judge_instances.py; the last line is for all of them. Diameters of
scaled variants are left out of it. Needs Python alone.
"""
import argparse
import csv
import math
import pathlib
import random
import struct
import subprocess
import tempfile

import judge_instances


def turned(points, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [(c * x - s * y, s * x + c * y, z, i) for x, y, z, i in points]


def mirrored(points):
    return [(-x, y, z, i) for x, y, z, i in points]


def scaled(points, by):
    return [(by * x, by * y, by * z, i) for x, y, z, i in points]


def thinned(points, share, chance):
    return [p for p in points if chance.random() < share]


def noisier(points, deviation, chance):
    """With white noise of this standard deviation (m) in depth."""
    factors = (1 + chance.gauss(0, deviation) / p[2] for p in points)
    return [(f * x, f * y, f * z, i) for f, (x, y, z, i) in zip(factors, points)]


def variants(points, seed):
    """(name, points, whether sizes are those of the callipers)"""
    chance = random.Random(seed)
    yield "as it is", points, True
    yield "mirrored", mirrored(points), True
    for _ in range(6):
        degrees = chance.uniform(10, 350)
        yield f"turned by {degrees:.0f} degrees", turned(points, degrees), True
    for _ in range(3):
        degrees = chance.uniform(10, 350)
        yield f"mirrored, turned by {degrees:.0f} degrees", turned(mirrored(points), degrees), True
    for share in (0.8, 0.65, 0.5, 0.25):
        yield f"{share:.0%} of the points", thinned(points, share, chance), True
    for deviation in (0.001, 0.002, 0.003):
        yield f"{1e3 * deviation:.0f} mm more noise", noisier(points, deviation, chance), True
    for by in (0.9, 0.95, 1.05, 1.1):
        yield f"scaled by {by}", scaled(points, by), False


def write_ply(path, points):
    head = "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    record = struct.Struct("<3f")
    path.write_bytes((head % len(points)).encode() + b"".join(record.pack(*p[:3]) for p in points))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("labelled")
    parser.add_argument("fruits")
    parser.add_argument("--agrisee", default="agrisee")
    parser.add_argument("--params")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", help="folder for the variants and the results; a temporary one without")
    arguments = parser.parse_args()
    with open(arguments.fruits) as file:
        callipers = list(csv.DictReader(file))
    everything = judge_instances.Judgement()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(arguments.out or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for name, points, true_size in variants(judge_instances.read_ply(arguments.labelled), arguments.seed):
            cloud, result = folder / "cloud.ply", folder / "result"
            write_ply(cloud, points)
            call = [arguments.agrisee, "process", str(cloud), "--viewpoint", "0,0,0", "-o", str(result), "--force"]
            subprocess.run(call + (["--params", arguments.params] if arguments.params else []), check=True,
                           stdout=subprocess.DEVNULL)
            one = judge_instances.judge(points, callipers, result)
            print(f"{name:32} {one.summary()}", flush=True)
            everything.found += one.found
            everything.fruits += one.fruits
            everything.others += one.others
            everything.visible += one.visible
            for kind, errors in one.errors.items():
                everything.errors[kind] += errors if true_size else []
    print(f"{'all':32} {everything.summary()}")


if __name__ == "__main__":
    main()
