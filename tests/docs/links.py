# SPDX-License-Identifier: BSD-3-Clause
"""Every link of the documents within the tree leads to something, every page of docs/ can be reached from the README,
and pictures are small enough to be kept in the tree.

  python3 links.py
"""
import os
import re
import sys

from documents import ROOT, anchors, blocks, documents

faults, leads = [], {}
for document in documents():
    leads[document] = set()
    for number, line in blocks(document)[1]:
        for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "``", line)):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            there = os.path.normpath(os.path.join(os.path.dirname(document), path)) if path else document
            if not os.path.exists(os.path.join(ROOT, there)):
                faults.append(f"{document}:{number}: {target} does not exist")
                continue
            leads[document].add(there)
            if anchor and there.endswith(".md") and anchor not in anchors(there):
                faults.append(f"{document}:{number}: {there} has no heading #{anchor}")

reached, ahead = set(), ["README.md"]
while ahead:
    document = ahead.pop()
    if document not in reached:
        reached.add(document)
        ahead += leads.get(document, ())
for document in leads:
    if document.startswith("docs" + os.sep) and document not in reached:
        faults.append(f"{document}: no link leads there from README.md")
images = os.path.join(ROOT, "docs", "images")
for name in sorted(os.listdir(images)):
    if os.path.getsize(os.path.join(images, name)) > 100000:
        faults.append(f"docs/images/{name}: above 100 kB")
    if name.endswith(".png") and os.path.join("docs", "images", name) not in reached:
        faults.append(f"docs/images/{name}: no document shows it")

print("\n".join(faults) or f"{sum(map(len, leads.values()))} links in {len(leads)} documents lead somewhere")
sys.exit(1 if faults else 0)
