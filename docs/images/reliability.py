#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The plot of docs/segmentation.md, and figures beside it: which share of the bodies of each confidence is fruit.

  python3 docs/images/reliability.py AGRISEE FOLDER      (keeps the scans in FOLDER; some 5 minutes on two cores)

Bodies are reported from a confidence of 0.02 on, in scans of 1, 3 and 8 views and in whole ones. A body is fruit if its center lies
within half a radius of a fruit's center, and the radii differ by less than a third.
"""
import concurrent.futures
import json
import math
import os
import subprocess
import sys

AGRISEE, FOLDER = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
PICTURE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "reliability.svg")
KINDS = ("tomato", "cherry", "pepper", "beefsteak", "pear", "strawberry")
SEEDS = range(30001, 30025)
NOISES = ("none", "l515", "rough", "gaussian:0.01")
VIEWS = {"a single view": [1], "several views": [3, 8, 30]}
BINS = 10


def run(*args):
    subprocess.run([AGRISEE, *args], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def plant(seed):
    folder = f"{FOLDER}/{seed}"
    if not os.path.exists(folder):
        run("make-plant", "--kind", KINDS[seed % 6], "--seed", str(seed), "--foliage", str((0.1, 0.2, 0.3)[seed // 6 % 3]),
            *(["--posts", "1"] if seed % 3 == 0 else ["--wires", "2"]), *(["--trunk"] if seed % 4 == 0 else []), "-o", folder)
    return folder


def bodies(job):
    """(confidence, whether it is fruit) of each body of a scan."""
    seed, noise, views = job
    scene, out = plant(seed), f"{FOLDER}/{seed}_{noise}_{views}"
    if not os.path.exists(f"{out}/fruits.json"):
        run("scan", scene, "-o", out, "--noise", noise, "--seed", "1", "--threads", "1", "--max-views", str(views), "--force",
            "--params", f"{FOLDER}/low.yaml")
    truth = json.load(open(f"{scene}/ground_truth.json"))["fruits"]

    def is_fruit(body):
        radius = sum(body["radii"]) / 3
        return any(math.dist(body["center_world"], t["center"]) < 0.5 * sum(t["radii"]) / 3
                   and abs(radius / (sum(t["radii"]) / 3) - 1) < 1 / 3 for t in truth)

    return [(b["confidence"], is_fruit(b)) for b in json.load(open(f"{out}/fruits.json"))]


def binned(found):
    """(bodies, fruit, mean confidence) of each tenth of the confidence."""
    tenths = [[0, 0, 0.0] for _ in range(BINS)]
    for p, fruit in found:
        tenth = tenths[min(int(BINS * p), BINS - 1)]
        tenth[0] += 1
        tenth[1] += fruit
        tenth[2] += p
    return tenths


def svg(series):
    left, top, side = 60, 20, 360
    at = lambda p, share: (left + side * p, top + side * (1 - share))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{left + side + 20}" height="{top + side + 90}" font-family="sans-serif" '
           'font-size="12"><rect width="100%" height="100%" fill="white"/>']
    for k in range(0, 11, 2):
        (x, y), text = at(k / 10, k / 10), f"{k / 10:.1f}"
        out.append(f'<path d="M{x:.0f} {top}V{top + side}M{left} {y:.0f}H{left + side}" stroke="#ddd"/>'
                   f'<text x="{x:.0f}" y="{top + side + 18}" text-anchor="middle">{text}</text>'
                   f'<text x="{left - 8}" y="{y + 4:.0f}" text-anchor="end">{text}</text>')
    out.append(f'<path d="M{left} {top + side}L{left + side} {top}" stroke="#888" stroke-dasharray="4 4"/>')
    for n, (name, color, tenths) in enumerate(series):
        line = []
        for count, fruit, total in tenths:
            if count < 5:
                continue
            share = fruit / count
            low, high = wilson(fruit, count)
            x, y = at(total / count, share)
            line.append(f"{x:.1f},{y:.1f}")
            out.append(f'<path d="M{x:.1f} {at(0, low)[1]:.1f}V{at(0, high)[1]:.1f}" stroke="{color}"/>'
                       f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{color}"/>')
        out.append(f'<polyline points="{" ".join(line)}" fill="none" stroke="{color}"/>'
                   f'<circle cx="{left + 10 + 170 * n}" cy="{top + side + 66}" r="4" fill="{color}"/>'
                   f'<text x="{left + 20 + 170 * n}" y="{top + side + 70}">{name}</text>')
    out.append(f'<text x="{left + side / 2}" y="{top + side + 42}" text-anchor="middle">confidence</text>'
               f'<text transform="translate(16 {top + side / 2}) rotate(-90)" text-anchor="middle">share that is fruit</text></svg>')
    return "\n".join(out) + "\n"


def wilson(k, n, z=1.96):
    """95 % interval of a share (Wilson, 1927)."""
    p, zz = k / n, z * z
    middle, half = (p + zz / (2 * n)) / (1 + zz / n), z * math.sqrt(p * (1 - p) / n + zz / (4 * n * n)) / (1 + zz / n)
    return middle - half, middle + half


def main():
    os.makedirs(FOLDER, exist_ok=True)
    with open(f"{FOLDER}/low.yaml", "w") as f:
        f.write("split: {bodies: {min_confidence: 0.02}}\n")
    series = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(plant, SEEDS))
        for (name, views), color in zip(VIEWS.items(), ("#d55e00", "#0072b2")):
            jobs = [(seed, noise, v) for seed in SEEDS for noise in NOISES for v in views]
            found = [b for each in pool.map(bodies, jobs) for b in each]
            series.append((name, color, binned(found)))
            print(f"{name}: {len(jobs)} scans, {len(found)} bodies")
            for k, (count, fruit, total) in enumerate(series[-1][2]):
                print(f"| {k / BINS:.1f} to {(k + 1) / BINS:.1f} | {count} | {fruit} | {fruit / count if count else 0:.2f} |")
            for limit in (0.5, 0.6, 0.7, 0.8):
                above = [fruit for p, fruit in found if p >= limit]
                print(f"from {limit}: precision {sum(above) / max(1, len(above)):.3f} of {len(above)}, "
                      f"{sum(above) / max(1, sum(f for _, f in found)):.3f} of the fruit")
    open(PICTURE, "w").write(svg(series))


if __name__ == "__main__":
    main()
