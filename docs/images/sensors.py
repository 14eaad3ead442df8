#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The picture of docs/sensors.md: one view of a plant by an ideal camera and by the noise models.

  python3 docs/images/sensors.py AGRISEE      (needs Pillow and NumPy: apt-get install python3-pil python3-numpy)
"""
import json
import os
import struct
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image, ImageDraw, ImageFont

FOLDER = os.path.dirname(os.path.abspath(__file__))
AGRISEE = os.path.abspath(sys.argv[1])
MODELS = [("none", "no errors"), ("l515-white", "l515-white"), ("l515", "l515"), ("azure", "azure"), ("d405", "d405"),
          ("l515:sun", "l515:sun")]
CROP = (330, 230, 700, 540)  # pixels of the view
SCALE = 0.75


def run(*args):
    subprocess.run([AGRISEE, *args], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def depths(path):
    """The depth image (m) of a recorded view, its focal lengths."""
    data = open(path, "rb").read()
    first = data.index(b"\n") + 1
    second = data.index(b"\n", first) + 1
    told = json.loads(data[first:second])["intrinsics"]
    image = np.zeros(told["width"] * told["height"], np.float32)
    at, pixel = second, 0
    while pixel < image.size:
        skip, count = struct.unpack_from("<II", data, at)
        at, pixel = at + 8, pixel + skip
        image[pixel:pixel + count] = np.frombuffer(data, "<f4", count, at)
        at, pixel = at + 4 * count, pixel + count
    return image.reshape(told["height"], told["width"]), told


def shaded(z, k):
    """Lit from the upper left: the light on the surface through neighbouring pixels. No return is white."""
    v, u = np.mgrid[0:z.shape[0], 0:z.shape[1]]
    points = np.dstack(((u - k["cx"]) / k["fx"] * z, (v - k["cy"]) / k["fy"] * z, z))
    normals = np.cross(points[2:, 1:-1] - points[:-2, 1:-1], points[1:-1, 2:] - points[1:-1, :-2])
    length = np.linalg.norm(normals, axis=2)
    light = normals @ (np.array([-0.4, -0.5, -0.77])) / np.maximum(length, 1e-12)
    out = np.full(z.shape, 255.0)
    out[1:-1, 1:-1] = np.where(z[1:-1, 1:-1] > 0, 40 + 190 * np.clip(light, 0, 1), 255)
    return Image.fromarray(out.astype(np.uint8))


def main():
    font = ImageFont.truetype("DejaVuSans-Bold.ttf", 13)
    width, height = int((CROP[2] - CROP[0]) * SCALE), int((CROP[3] - CROP[1]) * SCALE)
    sheet = Image.new("L", (3 * width + 20, 2 * (height + 24)), 255)
    with tempfile.TemporaryDirectory() as work:
        run("make-plant", "--kind", "tomato", "--seed", "7", "-o", f"{work}/plant")
        for i, (noise, name) in enumerate(MODELS):
            run("scan", f"{work}/plant/scene.yaml", "-o", f"{work}/{i}", "--noise", noise, "--seed", "1", "--planner",
                "fixed", "--max-views", "1", "--force")
            picture = shaded(*depths(f"{work}/{i}/views/0000.view")).crop(CROP).resize((width, height), Image.LANCZOS)
            x, y = i % 3 * (width + 10), i // 3 * (height + 24)
            sheet.paste(picture, (x, y + 22))
            ImageDraw.Draw(sheet).text((x + 6, y + 3), name, 40, font)
    sheet.quantize(12).save(os.path.join(FOLDER, "sensors.png"), optimize=True)


main()
