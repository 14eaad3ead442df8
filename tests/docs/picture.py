#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The README's picture, docs/truss.png, is what the command draws today: make demo's scan is drawn again and compared.

  picture.py AGRISEE ROOT WORK

On purpose it allows small differences, of other processors or libraries. To renew the picture: make demo, and
cp demo/result/truss.png docs/truss.png.
"""
import os
import subprocess
import sys
import zlib


def pixels(path):
    """Rows of a PNG with 8-bit RGB pixels, as bytes (the PNG specification, sections 5 and 9)."""
    data = open(path, "rb").read()
    at, packed, size = 8, b"", None
    while at < len(data):
        length, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            size = int.from_bytes(body[:4], "big"), int.from_bytes(body[4:8], "big")
            assert body[8:10] == b"\x08\x02" and body[12] == 0, f"{path}: not a plain RGB picture"
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    raw, (width, height) = zlib.decompress(packed), size
    stride, rows, above = 3 * width, [], bytes(3 * width)
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left, up, corner = (row[x - 3] if x >= 3 else 0), above[x], (above[x - 3] if x >= 3 else 0)
            if kind == 1:
                row[x] = (row[x] + left) & 255
            elif kind == 2:
                row[x] = (row[x] + up) & 255
            elif kind == 3:
                row[x] = (row[x] + (left + up) // 2) & 255
            elif kind == 4:
                a, b, c = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
                row[x] = (row[x] + (left if a <= b and a <= c else up if b <= c else corner)) & 255
        above = bytes(row)
        rows.append(above)
    return rows


def main():
    agrisee, root, work = sys.argv[1:]
    os.makedirs(work, exist_ok=True)
    os.chdir(work)
    run = lambda *arguments: subprocess.run([agrisee, *arguments], check=True, stdout=subprocess.DEVNULL)
    run("make-truss", "--total", "7", "--hidden", "1", "--seed", "1", "-o", "scene", "--force")
    run("scan", "scene/scene.yaml", "-o", "result", "--noise", "l515", "--seed", "1", "--force")
    now, then = pixels("result/truss.png"), pixels(os.path.join(root, "docs/truss.png"))
    if [len(now), len(now[0])] != [len(then), len(then[0])]:
        sys.exit("docs/truss.png has another size than what is drawn today; renew it (see this file)")
    differ = sum(a != b for row, old in zip(now, then) if row != old for a, b in zip(row, old)) / (len(now) * len(now[0]))
    print(f"{100 * differ:.3f} % of the values differ")
    if differ > 0.02:
        sys.exit("docs/truss.png is out of date; renew it (see this file)")


main()
