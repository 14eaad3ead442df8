#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Opens a result's cloud.ply in CloudCompare and MeshLab, as far as they are installed, and checks that what they save is
the same coloured cloud: viewers.py CLOUD_PLY WORK_FOLDER. Ends with 77 (skipped) where there is neither.
"""
import math
import os
import pathlib
import shutil
import struct
import subprocess
import sys

FORMATS = {"float": "f", "double": "d", "uchar": "B", "int": "i"}


def read_ply(path):
    """The vertices of a binary little-endian PLY, each a dictionary."""
    header, data = path.read_bytes().split(b"end_header\n", 1)
    words = [line.split() for line in header.decode().splitlines()]
    assert ["format", "binary_little_endian", "1.0"] in words, f"{path}: not binary"
    count, properties = 0, []
    for line in words:
        if line[:1] == ["element"]:
            vertices = line[1] == "vertex"
            count = int(line[2]) if vertices else count
        elif line[:1] == ["property"] and vertices:
            properties.append((line[2], FORMATS[line[1]]))
    row = struct.Struct("<" + "".join(format for _, format in properties))
    return [dict(zip([n for n, _ in properties], row.unpack_from(data, i * row.size))) for i in range(count)]


def run(command, output):
    output.unlink(missing_ok=True)
    environment = dict(os.environ)
    if "xvfb-run" not in command[0]:
        environment["QT_QPA_PLATFORM"] = "offscreen"
    done = subprocess.run(command, cwd=output.parent, env=environment, capture_output=True, text=True, timeout=240)
    if done.returncode != 0 or not output.exists():
        sys.exit(f"{' '.join(command)}: exit {done.returncode}\n{done.stdout}{done.stderr}")


def check(program, theirs, expected):
    """Theirs and ours have the same points (to 10 um), normals (which CloudCompare rounds) and colours, in one order."""
    if len(theirs) != len(expected):
        sys.exit(f"{program}: {len(theirs)} points of {len(expected)}")
    for i, (a, b) in enumerate(zip(theirs, expected)):
        same = all(math.isclose(a[k], b[k], abs_tol=1e-5) for k in ("x", "y", "z"))
        same = same and all(math.isclose(a[k], b[k], abs_tol=0.01) for k in ("nx", "ny", "nz"))
        if not same or any(a[k] != b[k] for k in ("red", "green", "blue")):
            sys.exit(f"{program}: point {i} is {a}, was {b}")
    colors = {(a["red"], a["green"], a["blue"]) for a in theirs}
    print(f"{program}: {len(theirs)} points in {len(colors)} colours")


source, work = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
work.mkdir(parents=True, exist_ok=True)
work = work.resolve()
expected = read_ply(source)
if len({(v["red"], v["green"], v["blue"]) for v in expected}) < 2:
    sys.exit(f"{source}: has one color alone")
shutil.copy(source, work / "cloud.ply")
ran = 0
if shutil.which("CloudCompare"):
    output = work / "cloud.asc"
    run(["CloudCompare", "-SILENT", "-NO_TIMESTAMP", "-C_EXPORT_FMT", "ASC", "-PREC", "7", "-ADD_HEADER",
         "-O", "cloud.ply", "-SAVE_CLOUDS"], output)
    header, *lines = output.read_text().splitlines()
    names = [{"r": "red", "g": "green", "b": "blue"}.get(n, n) for n in header.strip("/").lower().split()]
    check("CloudCompare", [dict(zip(names, map(float, line.split()))) for line in lines], expected)
    ran += 1
if shutil.which("meshlabserver") and shutil.which("xvfb-run"):
    output = work / "meshlab.ply"
    run(["xvfb-run", "-a", "meshlabserver", "-i", "cloud.ply", "-o", output.name, "-m", "vc", "vn"], output)
    check("MeshLab", read_ply(output), expected)
    ran += 1
if ran == 0:
    print("skipped: neither CloudCompare nor MeshLab (with xvfb-run) is installed")
    sys.exit(77)
