#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of docs/parameters.md: a truss scanned with a parameter too small, right and too large.

  python3 docs/images/make.py AGRISEE      (needs Pillow: apt-get install python3-pil)
"""
import json
import os
import subprocess
import sys
import tempfile

from PIL import Image, ImageDraw, ImageFont

FOLDER = os.path.dirname(os.path.abspath(__file__))
AGRISEE = os.path.abspath(sys.argv[1])
PANEL = (300, 290)

# name: options of all three, then caption, parameters and further options of each.
FIGURES = {
    "radius": ([], [("--radius 0.010,0.018", "", ["--radius", "0.010,0.018"]),
                    ("default: 0.008,0.06", "", []),
                    ("--radius 0.05,0.1", "", ["--radius", "0.05,0.1"])]),
    "separation": ([], [("surfels.separation 0.0006", "{surfels: {separation: 0.0006}}", []),
                        ("default: 0.0024", "", []),
                        ("surfels.separation 0.008", "{surfels: {separation: 0.008}}", [])]),
    "min_gain": ([], [("gain.min_gain 0.06", "{gain: {min_gain: 0.06}}", []),
                      ("default: 0.0008", "", []),
                      ("gain.min_gain 0", "{gain: {min_gain: 0}}", [])]),
    "sor": (["--noise", "rough", "--preset", "paper", "--max-views", "8"],
            [("sor.std_ratio 0.3", "{preset: paper, sor: {std_ratio: 0.3}}", []),
             ("paper: 2", "{preset: paper}", []),
             ("sor.std_ratio 20", "{preset: paper, sor: {std_ratio: 20}}", [])]),
    "smoothness": (["--preset", "paper", "--max-views", "8"],
                   [("split.growing.smoothness 5\u00b0", "{preset: paper, split: {growing: {smoothness: 0.087}}}", []),
                    ("paper: 12\u00b0", "{preset: paper}", []),
                    ("split.growing.smoothness 30\u00b0", "{preset: paper, split: {growing: {smoothness: 0.524}}}", [])]),
}


def run(*args):
    subprocess.run([AGRISEE, *args], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def panel(sheet, x, caption, result, oblique):
    with open(os.path.join(result, "run.json")) as file:
        told = json.load(file)
    with open(os.path.join(result, "fruits.json")) as file:
        fruits = len(json.load(file))
    picture = Image.open(os.path.join(result, "truss.png")).convert("RGB")
    left = picture.width // 2 if oblique else 0
    picture = picture.crop((left, 75, left + picture.width // 2, 830))
    picture.thumbnail(PANEL, Image.LANCZOS)
    sheet.paste(picture, (x + (PANEL[0] - picture.width) // 2, 42))
    draw = ImageDraw.Draw(sheet)
    draw.rectangle((x, 42, x + PANEL[0], 49), fill="white")  # rest of the picture's own caption
    font = lambda bold, size: ImageFont.truetype("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf", size)
    draw.text((x + 10, 5), caption, (31, 38, 48), font(True, 13))
    facts = f"{fruits} fruit, {told['views']} views, {told['points']['filtered']} points"
    draw.text((x + 10, 23), facts, (82, 92, 104), font(False, 12))


with tempfile.TemporaryDirectory() as work:
    os.chdir(work)
    run("make-truss", "--total", "7", "--hidden", "1", "--seed", "1", "-o", "truss")
    for name, (common, panels) in FIGURES.items():
        if len(sys.argv) > 2 and name not in sys.argv[2:]:
            continue
        sheet = Image.new("RGB", (3 * PANEL[0], PANEL[1] + 44), "white")
        for i, (caption, parameters, options) in enumerate(panels):
            with open("p.yaml", "w") as file:
                file.write(parameters or "{}")
            noise = [] if "--noise" in common else ["--noise", "l515"]
            run("scan", "truss/scene.yaml", "-o", f"r{i}", "--seed", "1", "--force", "--params", "p.yaml", *noise, *common, *options)
            panel(sheet, i * PANEL[0], caption, f"r{i}", oblique=name == "min_gain")
        sheet.quantize(256, kmeans=2, dither=Image.Dither.NONE).save(os.path.join(FOLDER, name + ".png"), optimize=True)
        print(name, os.path.getsize(os.path.join(FOLDER, name + ".png")))
