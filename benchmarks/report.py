#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the benchmark programs and writes docs/benchmarks.md and .csv: report.py BUILD_DIR OUTPUT.md [--large]

Wall time on an otherwise idle machine, medians of runs that are taken in random order, so that slow spells hit all alike.
--large adds the peers on 1.5 million points (half an hour); without it only ours are run there.
"""
import json
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
STAGES = {
    "density": "points within r of each, 1,500 (at 1.5 M: 300)",
    "radius_count": "points within r of each, 50",
    "knn": "20 nearest of each",
    "sor": "statistical outlier removal, K = 20",
    "normals": "normals, k = 25",
    "region_growing": "region growing, k = 25, 12 degrees, normals given",
    "dbscan": "DBSCAN, 20 neighbors, min 10",
    "chain": "outlier removal, normals, region growing, clustering",
    "icp": "ICP point to plane, 20 iterations, tree included",
    "voxel": "voxel averaging, 2 mm",
    "depth_frame": "depth frame 1024 x 768, 100 k triangles",
    "bvh_build": "tree over 100 k triangles",
    "ply_read": "binary PLY read",
    "ply_write": "binary PLY written",
    "stl_read": "STL read, triangles",
}


def output_of(*command):
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""


def run(program, pattern, repetitions):
    """The medians of a program's runs that match: name -> (ms of wall time, peak MB)."""
    done = subprocess.run([str(program), "--benchmark_format=json", f"--benchmark_repetitions={repetitions}",
                           "--benchmark_min_time=0.1", "--benchmark_report_aggregates_only=true",
                           "--benchmark_enable_random_interleaving=true", "--benchmark_filter=" + pattern],
                          stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:  # an answer that differs from a peer's, among others
        sys.exit(f"{program} failed with exit code {done.returncode}")
    out = {}
    for one in json.loads(done.stdout)["benchmarks"] if done.stdout.strip() else []:
        if one.get("aggregate_name") != "median":
            continue
        scale = {"ns": 1e-6, "us": 1e-3, "ms": 1.0}[one["time_unit"]]
        out[one["run_name"].replace("/real_time", "")] = (one["real_time"] * scale, one.get("peak_MB"))
    return out


def number(x):
    return f"{x:,.0f}" if x >= 100 else f"{x:.1f}" if x >= 10 else f"{x:.2f}"


def machine():
    cpu = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text())
    lines = [f"- {cpu.group(1) if cpu else 'unknown processor'}, {output_of('nproc')} cores",
             f"- {output_of('c++', '--version').splitlines()[0]}, `-O3`, no machine flags"]
    packages = output_of("dpkg-query", "-W", "-f", "${Package} ${Version}\n", "libpcl-dev", "libopen3d-dev",
                         "libnanoflann-dev", "libembree-dev", "libeigen3-dev")
    if packages:
        lines.append("- " + ", ".join(line.split("+")[0] for line in packages.splitlines()))
    return "\n".join(lines)


def comparison(results):
    rows = ["| stage | size | ours (ms) | fastest peer (ms) | times faster | ours, 2 threads (ms) |"
            " 2 threads, times faster | peak MB |",
            "|---|---|---|---|---|---|---|---|"]
    names = {}
    for name, value in results.items():
        stage, library, size, threads = name.split("/")
        names.setdefault((stage, int(size)), {})[library, int(threads)] = value
    for stage in STAGES:
        for (s, size), found in sorted(names.items()):
            if s != stage or ("ours", 1) not in found:
                continue
            ours, peak = found["ours", 1]

            def fastest(threads):
                """The fastest peer that uses at most so many threads; with two, only if one does use them."""
                peers = [(v[0], lib) for (lib, t), v in found.items() if lib != "ours" and t <= threads]
                if stage == "bvh_build":  # of like quality
                    peers = [p for p in peers if "medium" in p[1]]
                uses = any(lib != "ours" and t == threads for lib, t in found)
                return min(peers, default=None) if uses else None

            peer, two, peer_two = fastest(1), found.get(("ours", 2)), fastest(2)
            rows.append("| " + " | ".join([
                STAGES[stage], f"{size:,}", number(ours), f"{number(peer[0])} {peer[1]}" if peer else "",
                f"**{peer[0] / ours:.1f}**" if peer else "", number(two[0]) if two else "",
                f"{peer_two[0] / two[0]:.1f}" if two and peer_two else "", number(peak) if peak else ""]) + " |")
    return "\n".join(rows)


def compile_time():
    """Seconds for compiling the example of the README, with optimization."""
    begin = time.time()
    subprocess.run(["c++", "-std=c++17", "-O2", "-I", str(ROOT / "include"), "-isystem", "/usr/include/eigen3", "-c", "-o",
                    "/dev/null", str(ROOT / "examples/01_process_cloud.cpp")], check=True)
    return time.time() - begin


def main():
    build, target, large = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), "--large" in sys.argv
    stages = target.with_suffix(".csv")
    few = 3  # runs of what takes long
    repetitions = few if large else 5
    results = {}
    for program in sorted(build.glob("benchmarks/peers/peers_*")):
        if not program.is_file() or not program.stat().st_mode & 0o100:
            continue
        print(program.name, file=sys.stderr)
        results.update(run(program, ".*" if large else "-/1500000/", repetitions))
        if not large:
            results.update(run(program, "ours/1500000/", few))
    own = {}
    for program in sorted(build.glob("benchmarks/bench_*")):
        if program.is_file() and program.stat().st_mode & 0o100:
            print(program.name, file=sys.stderr)
            own.update({f"{program.name[6:]}: {name}": value for name, value in run(program, ".*", few).items()})
    text = ["# Benchmarks", "", "Written by `make bench`" + (" `LARGE=1`" if large else "") + " at " +
            output_of("git", "-C", str(ROOT), "rev-parse", "--short", "HEAD") + ".", "", machine(), "",
            "All libraries get the same cloud, a noisy truss, in one process; their answers are compared before anything is timed. Wall"
            f" time, medians of {repetitions} runs ({few} at 1.5 million points). Peers are PCL, Open3D, nanoflann and Embree. On other"
            f" machines expect the ratios, not the times. [{stages.name}]({stages.name}) has the times of our stages alone.", "",
            comparison(results)]
    text += ["", f"`examples/01_process_cloud.cpp`, the README's ten lines, compiles in {compile_time():.1f} s (`-O2`)."]
    text += ["", pathlib.Path(__file__).with_name("notes.md").read_text().strip()]
    target.write_text("\n".join(text) + "\n")
    stages.write_text("\n".join(["run,ms"] + [f"{name},{value[0]:.4g}" for name, value in own.items()]) + "\n")


if __name__ == "__main__":
    main()
