# SPDX-License-Identifier: BSD-3-Clause
"""The tables of docs/parameters.md against the program: every parameter once, in the program's order, with its default,
the paper's value where that differs, and the unit that its header states.

  python3 parameters.py AGRISEE WORKDIR
"""
import json
import math
import os
import re
import subprocess
import sys

from documents import ROOT, blocks

DOCUMENT = "docs/parameters.md"
UNITS = r"\((m|m2|rad|s|kg/m3|points / m3|pixels|cells)(?=[),;:/ ])"


def values(agrisee, work, preset):
    """The values of a preset as run.json states them, by name: those of an empty cloud, which is soon processed."""
    cloud, folder = os.path.join(work, "none.ply"), os.path.join(work, preset)
    with open(cloud, "w") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex 0\n" + "".join(f"property float {a}\n" for a in "xyz") + "end_header\n")
    subprocess.run([agrisee, "process", cloud, "-o", folder, "--preset", preset, "--force"], check=True, stdout=subprocess.DEVNULL)
    with open(os.path.join(folder, "run.json")) as file:
        tree = json.load(file)["parameters"]
    out = {}

    def walk(node, prefix):
        for key, value in node.items():
            if isinstance(value, dict):
                walk(value, prefix + key + ".")
            else:
                out[prefix + key] = value

    walk(tree, "")
    return out


def stated_units():
    """The unit in the docstring of every parameter, by name; "" where it states none."""
    structs = {}
    for folder, _, files in os.walk(os.path.join(ROOT, "include", "agrisee")):
        for name in files:
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                text = file.read()
            space = "see::" if os.path.basename(folder) == "see" else ""
            for struct, body in re.findall(r"struct (\w*Parameters) \{\n(.*?)\n\};", text, re.S):
                structs[space + struct] = re.findall(r"^  ([\w:]+) (\w+)\b(?: = [\w:]+\(\)|[^()\n]*?)[;}](?: +///< *(.*))?$", re.sub(r"deg\(([\d.]+)\)", r"\1", body), re.M)
    out = {}

    def walk(struct, prefix):
        for kind, field, told in structs[struct]:
            nested = kind if kind in structs else kind.split("::")[-1]
            if nested in structs and nested != "Parameters":
                walk(nested, prefix + field + ".")
            else:
                unit = re.search(UNITS, told or "")
                out[prefix + field] = unit.group(1).replace(" ", "") if unit else ""

    walk("Parameters", "")
    return out


def same(cell, value):
    """Whether a cell says the value: a word, or a number to four digits, with degrees in brackets or without."""
    if isinstance(value, bool):
        return cell == ("true" if value else "false")
    if isinstance(value, str):
        return cell == value
    match = re.fullmatch(r"(-?[\d.]+)(?: \(([\d.]+)\u00b0\))?", cell)
    if not match:
        return False
    if match.group(2) and abs(math.radians(float(match.group(2))) - value) > 1e-9:
        return False
    return abs(float(match.group(1)) - value) <= 1e-4 * abs(value)


agrisee, work = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
os.makedirs(work, exist_ok=True)
default, paper, units = values(agrisee, work, "default"), values(agrisee, work, "paper"), stated_units()
faults, seen = [], []
for number, line in blocks(DOCUMENT)[1]:
    row = re.match(r"\| `([\w.]+)` \|", line)
    if not row:
        continue
    name, cells = row.group(1), [c.strip() for c in line.strip().strip("|").split("|")]
    place = f"{DOCUMENT}:{number}: {name}"
    seen.append(name)
    if name not in default:
        faults.append(f"{place} is no parameter")
    elif len(cells) != 6:
        faults.append(f"{place}: {len(cells)} cells instead of 6")
    else:
        if not same(cells[1], default[name]):
            faults.append(f"{place}: the default is {default[name]}, not '{cells[1]}'")
        if not (paper[name] == default[name] if not cells[2] else paper[name] != default[name] and same(cells[2], paper[name])):
            faults.append(f"{place}: the paper's value is {paper[name]}, not '{cells[2]}'")
        known = ("m", "rad", "s", "kg/m3", "points/m3", "pixels", "cells")
        if (units[name] or cells[3] in known) and cells[3] != units[name]:
            faults.append(f"{place}: its header states the unit '{units[name]}', not '{cells[3]}'")
        if not cells[4]:
            faults.append(f"{place}: it is not said what it is")
for name in sorted(set(default) - set(seen)):
    faults.append(f"{DOCUMENT}: {name} is missing")
if not faults and seen != list(default):
    faults.append(f"{DOCUMENT}: {next(a for a, b in zip(seen, default) if a != b)} is not where the program has it, or is told twice")
print("\n".join(faults) or f"{len(seen)} parameters are as they are told")
sys.exit(1 if faults else 0)
