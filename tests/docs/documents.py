# SPDX-License-Identifier: BSD-3-Clause
"""Markdown documents as the tests of the documents see them: fenced blocks, links, headings."""
import os
import re
import subprocess

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))


class Block:
    """A fenced block: its language, the text, its first line in the document, and the comment on the line above it."""

    def __init__(self, document, language, line, note):
        self.document, self.language, self.line, self.note, self.lines = document, language, line, note, []

    @property
    def place(self):
        return f"{self.document}:{self.line}"


def documents():
    """All Markdown files of the tree, relative to its root."""
    found = []
    for folder, folders, files in os.walk(ROOT):
        folders[:] = sorted(f for f in folders if f not in ("build", "demo", "node_modules") and not f.startswith("."))
        found += [os.path.relpath(os.path.join(folder, f), ROOT) for f in sorted(files) if f.endswith(".md")]
    return found


def read(document):
    with open(os.path.join(ROOT, document), encoding="utf-8") as file:
        return file.read().splitlines()


def blocks(document):
    """The fenced blocks of a document, and its lines outside of them as (number, text)."""
    fenced, prose, block, note = [], [], None, ""
    for number, line in enumerate(read(document), 1):
        if block is not None:
            if line.strip() == "```":
                fenced.append(block)
                block = None
            else:
                block.lines.append(line)
        elif line.strip().startswith("```"):
            block = Block(document, line.strip()[3:].strip(), number + 1, note)
        else:
            prose.append((number, line))
        comment = re.fullmatch(r"\s*<!--\s*(.*?)\s*-->\s*", line)
        note = comment.group(1) if comment else ""
    assert block is None, f"{document}: a block does not end"
    return fenced, prose


def anchors(document):
    """The anchors of a document's headings, as GitHub makes them."""
    out = set()
    for _, line in blocks(document)[1]:
        heading = re.match(r"#+\s+(.*)", line)
        if not heading:
            continue
        text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1)).lower()
        anchor = re.sub(r"[^\w\- ]", "", text).strip().replace(" ", "-")
        while anchor in out:
            anchor += "-1"
        out.add(anchor)
    return out
