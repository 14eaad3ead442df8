#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Changes the code at random and lists the changes that no test notices.

  python3 tests/mutate.py [--count N] [--seed S] [--work DIR] [--timeout SECONDS] FILE_OR_FOLDER...

For example `python3 tests/mutate.py --count 60 src/plan include/agrisee/plan`. Every change (a "mutant") is a comparison,
a sign, a constant or a condition that is altered, or a statement that is removed. All of them are built into one copy of
the sources, in DIR (default build/mutants), each behind a switch that an environment variable turns on. So the test
program nearest to a file, tests/<room>, is compiled once and then run once a mutant; a mutant is caught when the program
fails, crashes or runs for longer than SECONDS (default 60). Prints a line a survivor and, per room, how many were caught.

Some survivors change nothing that can be seen (a reserve() less, a tie that never happens); judge these by hand.
Exits with 0 whatever survives.
"""
import argparse
import collections
import concurrent.futures
import functools
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SWITCH = """#pragma once
#include <cstdlib>
inline bool mutant(int number) {
  static const char* const text = std::getenv("AGRISEE_MUTANT");
  static const int chosen = text ? std::atoi(text) : -1;
  return chosen == number;
}
"""
OTHER = {" < ": " <= ", " <= ": " < ", " > ": " >= ", " >= ": " > ", " == ": " != ", " != ": " == "}
SIGN = {" + ": " - ", " - ": " + ", " * ": " / "}
STATEMENT = re.compile(r"^( *)((?:\+\+|--)?[a-z_][\w.]*(?:\[[^\]]*\]|\([^()]*\)|\.|->|::|\w)*(?: (?:[-+*/|&]?=) .*|\+\+|--|\(.*\))?;)$")
JUMP = re.compile(r"^( *)if \((.*)\) (continue|break|return\b[^;]*);$")
CONDITION = re.compile(r"^( *(?:\} else )?(?:if|while) \()(.*)(\) \{)$")
NUMBER = re.compile(r"(?<![\w.\[])(\d+\.\d+(?:e-?\d+)?f?|\d+)(?![\w.])")
NEVER = re.compile(r"constexpr|reserve\(|static_assert|template|#|\"|case |enum|using |operator|= default|= delete|throw|check_|//!")


@functools.lru_cache(maxsize=None)
def source(file):
    """The text of a file, as it was when this program first read it: it may be edited meanwhile."""
    return (ROOT / file).read_text()


def operand(line, at, step):
    """How far the operand to one side of position `at` reaches."""
    depth = 0
    stops = ("&&", "||", "?", ":", ",", ";", "{", "}", " = ", " += ", " -= ", "return ", " < ", " > ", " <= ", " >= ", " == ", " != ")
    i = at
    while 0 <= i < len(line):
        c = line[i]
        if c in ("(", "[") if step > 0 else c in (")", "]"):
            depth += 1
        elif c in (")", "]") if step > 0 else c in ("(", "["):
            if depth == 0:
                return i
            depth -= 1
        elif depth == 0:
            for stop in stops:
                if stop == ":" and (line[i - 1:i + 1] == "::" or line[i:i + 2] == "::"):
                    continue
                if step > 0 and line.startswith(stop, i):
                    return i
                if step < 0 and line.endswith(stop, 0, i + 1):
                    return i
        i += step
    return i


def sites(line):
    """All changes of a line: (what is changed, function from the mutant's number to the changed line)."""
    code = line.split(" // ")[0].split("  ///")[0].rstrip()
    if not code.strip() or code.lstrip().startswith(("//", "*")) or NEVER.search(code) or code.count("(") != code.count(")"):
        return
    for table, kind in ((OTHER, "comparison"), (SIGN, "sign")):
        for sign, other in table.items():
            for found in re.finditer(re.escape(sign), code):
                left, right = operand(code, found.start() - 1, -1) + 1, operand(code, found.end(), 1)
                a, b = code[left:found.start()].strip(), code[found.end():right].strip()
                if not a or not b or a.startswith(("for", "if")):
                    continue
                before = code[:left] + (" " if code[left:left + 1] == " " else "")
                yield (f"{kind} '{sign.strip()}' -> '{other.strip()}'",
                       lambda n, p=before, a=a, b=b, s=sign, o=other, q=code[right:]:
                       f"{p}(mutant({n}) ? ({a}{o}{b}) : ({a}{s}{b})){q}")
    for found in NUMBER.finditer(code):
        x = found.group(1)
        changed = f"({x} + 1)" if "." not in x else f"({x} * 1.5f + 0.001f)" if x.endswith("f") else f"({x} * 1.5 + 0.001)"
        yield (f"constant {x} -> {changed}",
               lambda n, p=code[:found.start()], x=x, c=changed, q=code[found.end():]: f"{p}(mutant({n}) ? {c} : {x}){q}")
    if match := JUMP.match(code):
        space, condition, jump = match.groups()
        if "; " not in condition:
            yield ("removed: " + code.strip(), lambda n: f"{space}if (({condition}) && !mutant({n})) {jump};")
    elif match := STATEMENT.match(code):
        space, statement = match.groups()
        if not statement.startswith(("return", "break", "continue")):
            yield ("removed: " + statement, lambda n: f"{space}{{ if (!mutant({n})) {statement} }}")  # braces: an else may follow
    if match := CONDITION.match(code):
        head, condition, tail = match.groups()
        if "; " not in condition and " = " not in condition:
            yield ("condition negated", lambda n: f"{head}mutant({n}) ? !({condition}) : bool({condition}){tail}")


def find(files, count, rng):
    """`count` random changes a room, at most one a line: {number: (file, line index, what, function)}."""
    rooms = collections.defaultdict(list)
    for file in files:
        lines = source(file).split("\n")
        for i, line in enumerate(lines):
            if i > 0 and lines[i - 1].rstrip().endswith(("=", "(", ",", "&&", "||", "+", "-", "?", ":")):
                continue  # the middle of a statement
            options = list(sites(line))
            if options:
                rooms[room_of(file)].append((file, i, *rng.choice(options)))
    chosen = {}
    for room in sorted(rooms):
        rng.shuffle(rooms[room])
        for change in rooms[room][:2 * count]:
            chosen[len(chosen)] = change
    return chosen


def room_of(file):
    return pathlib.Path(file).parent.name


def write_tree(work, mutants):
    """The copy of the sources with all mutants in it."""
    changed = collections.defaultdict(dict)
    for number, (file, i, _, change) in mutants.items():
        changed[file][i] = (number, change)
    for file, lines_changed in changed.items():
        lines = source(file).split("\n")
        for i, (number, change) in lines_changed.items():
            lines[i] = change(number)
        target = work / "tree" / file
        text = "\n".join(lines)
        if target.read_text() != text:
            target.write_text(text)


def build(work, mutants, targets):
    """Compile; changes that do not compile are taken out."""
    tree, out = work / "tree", work / "build"
    (tree / "mutant.hpp").write_text(SWITCH)
    subprocess.run(["cmake", "-S", tree, "-B", out, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None",
                    f"-DCMAKE_CXX_FLAGS=-O1 -DNDEBUG -w -include {tree}/mutant.hpp", "-DAGRISEE_BUILD_ORACLES=OFF",
                    "-DAGRISEE_BUILD_EXAMPLES=OFF"], check=True, stdout=subprocess.DEVNULL)
    for attempt in range(20):
        write_tree(work, mutants)
        run = subprocess.run(["cmake", "--build", out, "--target", *targets, "--", "-k", "0"], capture_output=True, text=True)
        if run.returncode == 0:
            return
        wrong = set()
        for file, line in re.findall(re.escape(str(tree)) + r"/([^:\s]+):(\d+)", run.stdout):
            wrong.update(n for n, m in mutants.items() if m[0] == file and m[1] == int(line) - 1)
        if not wrong:
            sys.exit(run.stdout[-4000:])
        print(f"{len(wrong)} changes do not compile and are left out", file=sys.stderr)
        for n in wrong:
            # Put the line back, in this and all later attempts.
            file = mutants[n][0]
            (tree / file).write_text(source(file))
            del mutants[n]
    sys.exit("the changed sources do not compile")


def caught(program, number, timeout):
    try:
        run = subprocess.run([program, "--abort"], env={**os.environ, "AGRISEE_MUTANT": str(number)}, timeout=timeout,
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=program.parent)
        return run.returncode != 0
    except subprocess.TimeoutExpired:
        return True


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("places", nargs="+", help="files or folders, relative to the repository")
    parser.add_argument("--count", type=int, default=60, help="mutants a room")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/mutants")
    parser.add_argument("--timeout", type=float, default=60.0)
    options = parser.parse_args()
    files = []
    for place in options.places:
        path = ROOT / place
        found = sorted(path.rglob("*.[ch]pp")) if path.is_dir() else [path]
        files += [str(f.relative_to(ROOT)) for f in found if f.name != "parameters.hpp"]
    mutants = find(files, options.count, random.Random(options.seed))
    work = options.work.resolve()
    tracked = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\n")
    for file in filter(None, tracked):
        target = work / "tree" / file
        if (ROOT / file).is_file():
            target.parent.mkdir(parents=True, exist_ok=True)
            if not target.exists() or target.read_bytes() != (ROOT / file).read_bytes():
                shutil.copyfile(ROOT / file, target)
    rooms = sorted({room_of(m[0]) for m in mutants.values()})
    build(work, mutants, ["test_" + room for room in rooms])
    for room in rooms:
        program = work / "build/tests" / ("test_" + room)
        if caught(program, -1, 10 * options.timeout):
            sys.exit(f"{program} fails without any change")
        numbers = [n for n in mutants if room_of(mutants[n][0]) == room][:options.count]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            verdicts = list(pool.map(lambda n: caught(program, n, options.timeout), numbers))
        for n, verdict in zip(numbers, verdicts):
            if not verdict:
                print(f"survived: {mutants[n][0]}:{mutants[n][1] + 1}: {mutants[n][2]}")
        print(f"{room}: {sum(verdicts)} of {len(numbers)} caught", flush=True)


if __name__ == "__main__":
    main()
