# SPDX-License-Identifier: BSD-3-Clause
"""How long `process` takes from NumPy, and in C++ on the same points, in turns.

  PYTHONPATH=build/release/python python3 benchmarks/python_process.py build/release/src/python/agrisee_python_peer [ROUNDS]

`cmake --build build/release --target agrisee_python_peer` builds the C++ half. Prints a table for docs/python.md.
"""
import os
import statistics
import subprocess
import sys
import tempfile
import time

import agrisee
import numpy as np


def one_view(folder):
    """Points of one simulated view of a truss of seven fruit (float32, world), and where it was taken from."""
    scene = agrisee.make_truss(folder, total=7, hidden=1, seed=1)
    camera = agrisee.SimulatedCamera(scene, noise="l515", seed=1)
    pose = agrisee.Pipeline(scene).next_view().pose
    depth, k = camera.capture(pose), camera.workcell.intrinsics
    v, u = np.nonzero(depth)
    z = depth[v, u]
    points = np.c_[(u - k["cx"]) / k["fx"] * z, (v - k["cy"]) / k["fy"] * z, z] @ pose[:3, :3].T + pose[:3, 3]
    return points.astype(np.float32), pose[:3, 3]


def two_spheres(n):
    """About n points on the fronts of two spheres (float32), and where they are seen from."""
    i = np.arange(n)
    z = 1 - (2 * i + 1) / n
    s = np.sqrt(1 - z * z)
    d = np.c_[s * np.cos(2.3999632 * i), s * np.sin(2.3999632 * i), z]
    d = d[d[:, 1] < 0]
    return np.concatenate([[x, 0.5, 0.2] + 0.035 * d for x in (-0.035, 0.035)]).astype(np.float32), np.array([0, 0, 0.2])


def compare(peer, folder, name, points, viewpoint, threads, rounds):
    path = os.path.join(folder, "points.bin")
    points.tofile(path)
    process = subprocess.Popen([peer, path, str(threads), *map(repr, map(float, viewpoint))], stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE, text=True)
    here, there = [], []  # (seconds, processor time)
    for turn in range(rounds + 1):
        begin = time.perf_counter(), time.process_time()
        result = agrisee.process(points, viewpoint=viewpoint, threads=threads)
        mine = time.perf_counter() - begin[0], time.process_time() - begin[1]
        process.stdin.write("\n")
        process.stdin.flush()
        fruits, *theirs = process.stdout.readline().split()
        assert int(fruits) == len(result.fruits)
        if turn > 0:  # the first warms up
            here.append(mine)
            there.append(tuple(map(float, theirs)))
    process.stdin.close()
    process.wait()
    cells = [name, f"{len(points):,}", str(threads)]
    for kind in (0, 1):
        a, b = [times[kind] for times in here], [times[kind] for times in there]
        cells += [f"{1e3 * statistics.median(b):.1f}", f"{1e3 * statistics.median(a):.1f}",
                  f"{100 * (statistics.median(x / y for x, y in zip(a, b)) - 1):+.1f} %"]
    print("| " + " | ".join(cells) + " |", flush=True)


peer, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 21
print("| cloud | points | threads | C++ ms | Python ms | median of the pairs | C++ processor ms | Python | median of the pairs |")
print("|---|---|---|---|---|---|---|---|---|")
with tempfile.TemporaryDirectory() as work:
    for title, (cloud, seen_from) in (("two fruit", two_spheres(20000)), ("one view of a truss", one_view(work)),
                                      ("two fruit, dense", two_spheres(300000))):
        for count in (1, 2):
            compare(peer, work, title, cloud, seen_from, count, rounds)
