# SPDX-License-Identifier: BSD-3-Clause
"""The snippets of the documents, compiled and run.

  python3 snippets.py cpp WORKDIR COMPILER FOLDERS...  ```cpp blocks; FOLDERS of headers, separated by colons
  python3 snippets.py shell WORKDIR AGRISEE [PYTHON FOLDER]
                                                       ```sh and ```python blocks, and other lines that call agrisee;
                                                       an interpreter, and the folder of the package agrisee

A ```cpp block with `<!-- from: FILE -->` above it consists of lines of that file, which a ctest of its own compiles and
runs. All others are compiled, not run, with what tests/docs/context.hpp declares: a whole program as it is, others
as the body of a function below their #include lines.
The ```sh and ```python blocks of a document are run one after the other, in a folder of the document's own. In other
blocks, lines that begin with `agrisee` are not run: that the command has their options is checked. ```python blocks
that import agrisee are run only if the package is there.
"""
import os
import re
import shutil
import subprocess
import sys

from documents import ROOT, blocks, documents


def fail(message):
    print(message)
    sys.exit(1)


def is_part_of(block, path):
    """Whether the block's lines stand in the file in this order, blank ones and indentation aside."""
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        lines = iter([line.strip() for line in file])
    return all(any(line.strip() == other for other in lines) for line in block.lines if line.strip())


def compile_cpp(work, compiler, folders):
    includes, bodies, count = {}, [], 0
    for document in documents():
        for block in blocks(document)[0]:
            if block.language != "cpp":
                continue
            count += 1
            if block.note.startswith("from: "):
                if not is_part_of(block, block.note[6:]):
                    fail(f"{block.place}: is not what {block.note[6:]} says")
                continue
            name, program = f"snippet_{count}", any(re.match(r"int main\(", line) for line in block.lines)
            body = [f'#line {block.line} "{os.path.join(ROOT, block.document)}"']
            for line in block.lines:
                if line.startswith("#include"):
                    includes[line] = True
                body.append("" if line.startswith("#include") else line)
            if program:  # as it is, but under a name that can stand beside others
                body = [f"namespace {name} {{", "#define main program", *body, "#undef main", "}"]
            else:
                body = [f"void {name}();", f"void {name}() {{", *body, "}"]
            bodies += body
    source = os.path.join(work, "snippets.cpp")
    with open(source, "w", encoding="utf-8") as file:
        file.write("\n".join(['#include "context.hpp"', *includes, *bodies]) + "\n")
    here = os.path.dirname(os.path.abspath(__file__))
    quiet = ["-Wno-unused-variable", "-Wno-unused-but-set-variable", "-Wno-missing-declarations"]
    # After all other folders, since /usr/include among them would lose its place.
    after = [flag for folder in ":".join(folders).split(":") if folder for flag in ("-idirafter", folder)]
    command = [compiler, *after, "-std=c++17", "-fsyntax-only", "-I", here, "-I", os.path.join(ROOT, "include"),
               "-Wall", "-Wextra", "-Wconversion", "-Werror", *quiet, source]
    if subprocess.run(command).returncode:
        fail("a C++ block does not compile")
    print(f"{count} C++ blocks compile, or are part of what does")


def options_of(agrisee, command, known={}):
    if command not in known:
        told = subprocess.run([agrisee, command, "--help"], capture_output=True, text=True)
        known[command] = set(re.findall(r"(?<![\w-])--?[a-z][\w-]*", told.stdout)) if told.returncode == 0 else None
    return known[command]


def check_options(agrisee, place, line):
    line = line.split("#")[0].split("|")[0].split(">")[0]
    words = line.split()
    if len(words) < 2 or words[1].startswith("-"):
        return
    known = options_of(agrisee, words[1])
    if known is None:
        fail(f"{place}: agrisee has no command '{words[1]}'")
    for word in words[2:]:
        if re.match(r"--?[a-z]", word) and word not in known:
            fail(f"{place}: agrisee {words[1]} has no option {word}")


def run_shell(work, agrisee, python=None, package=None):
    binary = os.path.join(work, "bin")
    os.makedirs(binary)
    os.symlink(agrisee, os.path.join(binary, "agrisee"))
    environment = {**os.environ, "PATH": binary + os.pathsep + os.environ["PATH"]}
    with_package = {**environment, "PYTHONPATH": package or ""}
    ran = checked = skipped = 0
    for document in documents():
        folder = os.path.join(work, document.replace(os.sep, "_"))
        for block in blocks(document)[0]:
            if block.language in ("sh", "python"):
                os.makedirs(folder, exist_ok=True)
                script = "\n".join(block.lines) + "\n"
                needs_package = block.language == "python" and "import agrisee" in script
                if needs_package and not package:
                    skipped += 1
                    continue
                command = ["bash", "-euo", "pipefail", "-c"] if block.language == "sh" else [python or sys.executable, "-B", "-c"]
                done = subprocess.run([*command, script], cwd=folder, env=with_package if needs_package else environment,
                                      capture_output=True, text=True)
                if done.returncode:
                    fail(f"{block.place}: ends with {done.returncode}\n{done.stdout}{done.stderr}")
                ran += 1
            elif block.language != "cpp":
                text = "\n".join(block.lines).replace("\\\n", " ")
                for line in text.split("\n"):
                    if line.startswith("agrisee "):
                        check_options(agrisee, block.place, line)
                        checked += 1
        for number, line in blocks(document)[1]:
            for code in re.findall(r"`(agrisee [^`]*)`", line):
                if re.match(r"agrisee [a-z][a-z-]+", code):
                    check_options(agrisee, f"{document}:{number}", code)
                    checked += 1
    print(f"{ran} blocks run, {checked} further command lines have options that exist")
    if skipped:
        print(f"{skipped} blocks skipped: they need the Python module (AGRISEE_BUILD_PYTHON)")


what, work = sys.argv[1], os.path.abspath(sys.argv[2])
shutil.rmtree(work, ignore_errors=True)
os.makedirs(work)
if what == "cpp":
    compile_cpp(work, sys.argv[3], sys.argv[4:])
else:
    run_shell(work, os.path.abspath(sys.argv[3]), *sys.argv[4:])
