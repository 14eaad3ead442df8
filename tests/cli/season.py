# SPDX-License-Identifier: BSD-3-Clause
"""Lists that skip what is done, the database of a season, and its page.

  python3 season.py AGRISEE WORKDIR CASE      one of the cases below; exit code 77: built without SQLite
"""
import fcntl
import json
import os
import random
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import time

AGRISEE, WORK, CASE = os.path.abspath(sys.argv[1]), os.path.join(sys.argv[2], "season_" + sys.argv[3]), sys.argv[3]
CASES = {}
FEW_FILES = ["--no-picture", "--no-report", "--quiet"]


def case(function):
    CASES[function.__name__] = function
    return function


def run(*words, code=0):
    done = subprocess.run([AGRISEE, *words], capture_output=True, text=True)
    assert done.returncode == code, (words, done.returncode, done.stdout, done.stderr)
    return done.stdout + done.stderr


def needs_sqlite():
    if "no SQLite" in run("--version"):
        assert "without SQLite" in run("season", "s.sqlite", "-o", "s.html", code=1)
        print("SKIPPED: the database of a season (agrisee was built without SQLite)")
        sys.exit(77)


def ball(path, radius=0.03, seed=1):
    """A cloud of half a ball."""
    rng, points = random.Random(seed), []
    while len(points) < 1500:
        p = [rng.gauss(0, 1) for _ in range(3)]
        length = sum(x * x for x in p) ** 0.5
        if p[1] < 0:
            points.append([radius * x / length + c for x, c in zip(p, (0, 0.4, 0))])
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(points) +
                   "".join(f"property float {a}\n" for a in "xyz") + "end_header\n" +
                   "".join("%.5f %.5f %.5f\n" % tuple(p) for p in points))


def process(*words, code=0):
    return run("process", "in/*.ply", "-o", "out", "--viewpoint", "0,0,0", *FEW_FILES, *words, code=code)


def made(folder="out"):
    return {d: os.stat(f"{folder}/{d}/run.json").st_mtime_ns for d in os.listdir(folder)
            if os.path.exists(f"{folder}/{d}/run.json")}


@case
def keyed():
    """What has the same content, parameters and version is skipped; all else is done again."""
    for name in "abc":
        ball(f"in/{name}.ply")
    assert "3 inputs, 0 failed" in process()
    first = made()
    assert "3 inputs, 3 done before, 0 failed" in process() and made() == first
    with open("out/summary.csv", encoding="utf-8") as file:
        assert file.read().count(",ok,1,") == 3

    def redone(folders, *words):
        before = made()
        process(*words)
        after = made()
        assert sorted(d for d in after if after[d] != before.get(d)) == folders, (folders, before, after)

    ball("in/b.ply", radius=0.025)
    redone(["b"])
    redone(["a", "b", "c"], "--seed", "2")
    redone([], "--seed", "2", "--threads", "1")  # does not change a result
    with open("p.yaml", "w", encoding="utf-8") as file:
        file.write("max_views: 7\n")
    redone(["a", "b", "c"], "--params", "p.yaml")
    redone([], "--params", "p.yaml")
    os.remove("out/c/fruits.csv")
    redone(["c"], "--params", "p.yaml")
    redone(["a", "b", "c"], "--params", "p.yaml", "--force")
    ball("in/d.ply")
    redone(["d"], "--params", "p.yaml")
    # Names that become ambiguous change nothing for what is done, whether both or only the new input is named.
    ball("other/a.ply")
    words = ["-o", "out", "--viewpoint", "0,0,0", *FEW_FILES, "--params", "p.yaml"]
    before = made()
    assert "5 inputs, 4 done before, 0 failed" in run("process", "in/*.ply", "other/a.ply", *words)
    assert "1 inputs, 1 done before, 0 failed" in run("process", "other/a.ply", "--shard", "1/1", *words)
    assert {**made(), **before} == made() and sorted(set(made()) - set(before)) == ["other_a"], made()
    shutil.rmtree("other")
    # The files of options stay.
    assert "is an input" in run("process", "in/[ab].ply", "-o", "out", "--params", "out/a/run.json", code=2)
    assert os.path.exists("out/a/fruits.json")
    # A result that the list did not make is neither skipped nor overwritten.
    run("process", "in/a.ply", "-o", "out/a", "--force", *FEW_FILES)
    assert "out/a: already holds a result" in process("--params", "p.yaml", code=2)
    shutil.rmtree("out/a")
    # One that fails leaves no result behind, and is run again.
    with open("in/b.ply", "w", encoding="utf-8") as file:
        file.write("ply\ndamaged\n")
    process("--params", "p.yaml", code=2)
    assert "b" not in made()
    ball("in/b.ply")
    redone(["b"], "--params", "p.yaml")


@case
def json_lines():
    """Of a list, --json prints one document a line, and nothing else on standard output."""
    for name in "ab":
        ball(f"in/{name}.ply")
    with open("in/c.ply", "w", encoding="utf-8") as file:
        file.write("ply\ndamaged\n")
    run("make-truss", "--total", "3", "--hidden", "0", "--seed", "1", "-o", "t1")
    shutil.copytree("t1", "t2")
    for words, code, count in ([["process", "in/*.ply", "-o", "out", "--viewpoint", "0,0,0"], 2, 2],
                               [["scan", "t1", "t2", "-o", "scans", "--max-views", "1"], 0, 2],
                               [["scan", "t1", "t2", "-o", "scans", "--max-views", "1"], 0, 0]):
        done = subprocess.run([AGRISEE, *words, *FEW_FILES, "--json"], capture_output=True, text=True)
        documents = [json.loads(line) for line in done.stdout.splitlines()]
        assert done.returncode == code and len(documents) == count, (words, done)
        assert all(os.path.isdir(one["folder"]) and len(one["fruits"]) > 0 for one in documents), documents
        assert " inputs, " in done.stderr and ("failed: in/c.ply" in done.stderr) == (code == 2), done.stderr


@case
def interrupted():
    """A list of scans that is stopped goes on by the same command, with the views that it has."""
    for n in 1, 2:
        run("make-truss", "--total", "3", "--hidden", "0", "--seed", str(n), "-o", f"in/t{n}")
        with open(f"in/t{n}/scene.yaml", encoding="utf-8") as file:
            text = file.read()
        with open(f"in/t{n}/scene.yaml", "w", encoding="utf-8") as file:
            file.write(text.replace("width: 1024", "width: 512").replace("height: 768", "height: 384"))
    scan = ["scan", "in/*/scene.yaml", "--max-views", "6", "--noise", "rough", *FEW_FILES, "-o"]
    run(*scan, "whole")
    process = subprocess.Popen([AGRISEE, *scan, "out"], stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    while process.poll() is None and not os.path.exists("out/t1/views/0001.view"):
        time.sleep(0.002)
    process.send_signal(signal.SIGINT)
    error = process.communicate()[1]
    assert process.returncode == -signal.SIGINT and "stopped; the same command goes on" in error, error
    with open("out/summary.csv", encoding="utf-8") as file:
        assert file.read().count(",open,") == 2
    assert "--unfinished" in run("merge", "--help")
    first = os.stat("out/t1/views/0000.view").st_mtime_ns
    assert "2 inputs, 0 failed" in run(*scan, "out")
    assert os.stat("out/t1/views/0000.view").st_mtime_ns == first, "a view was taken twice"
    for n in 1, 2:
        with open(f"out/t{n}/fruits.json", "rb") as a, open(f"whole/t{n}/fruits.json", "rb") as b:
            assert a.read() == b.read(), "another result"
    # Where another process works, nothing is touched; the lock ends with that process.
    lock = os.open("out/t1", os.O_RDONLY)
    fcntl.flock(lock, fcntl.LOCK_EX)
    for words in [*scan, "out", "--force"], ["scan", "--resume", "out/t1"], ["scan", "in/t1", "-o", "out/t1", "--force"], \
            ["process", "out/t2/cloud.ply", "-o", "out/t1", "--force"]:
        assert "out/t1: another process works in this folder" in run(*words, code=2)
    with open("out/t1/fruits.json", "rb") as a, open("whole/t1/fruits.json", "rb") as b:
        assert a.read() == b.read(), "a result of another process was touched"
    os.close(lock)
    assert "2 inputs, 2 done before, 0 failed" in run(*scan, "out")
    # Shards that were stopped or never started are named.
    shard = [*scan, "three", "--shard"]
    run(*shard, "2/3")
    assert run("merge", "three", "--unfinished") == "1,3\n"
    assert "summary-1-of-3.csv: is missing" in run("merge", "three", code=2)
    run(*shard, "1/3")
    run(*shard, "3/3")
    assert run("merge", "three", "--unfinished") == ""
    with open("three/summary-1-of-3.csv", encoding="utf-8") as file:
        stopped = file.read().replace(",ok,", ",open,")
    with open("three/summary-1-of-3.csv", "w", encoding="utf-8") as file:
        file.write(stopped)
    assert "Run shards 1 again" in run("merge", "three", code=2)
    # Why a scan failed is in the summary.
    with open("in/t1/scene.yaml", encoding="utf-8") as file:
        text = file.read()
    os.makedirs("far")
    for name in os.listdir("in/t1"):
        shutil.copy("in/t1/" + name, "far")
    with open("far/scene.yaml", "w", encoding="utf-8") as file:
        file.write(re.sub(r"(base: *\{? *xyz: *\[)[^]]*\]", r"\g<1>5, 5, 5]", text))
    told = run("scan", "far/scene.yaml", "-o", "four", "--shard", "1/1", *FEW_FILES, code=2)
    with open("four/summary.csv", encoding="utf-8") as file:
        assert "no view could be taken (" in file.read() and "no view could be taken" in told
    with open("four/far/job.json", encoding="utf-8") as file:
        assert "out of the arm's reach" in json.load(file)["message"]
    run("scan", "far/scene.yaml", "-o", "five", *FEW_FILES, code=3)
    # Those of another number of shards are named.
    run(*shard, "2/2")
    assert "written are of 2; if these are to stay, delete summary-*-of-3.csv" in run("merge", "three", code=2)
    # A result is no list, and a list no result.
    assert "holds the results of a list" in run("scan", "in/t1/scene.yaml", "-o", "three", "--force", code=1)
    os.makedirs("single")
    with open("single/summary.csv", "w", encoding="utf-8") as file:
        file.write("of another program\n")
    run("scan", "in/t1/scene.yaml", "-o", "single", "--max-views", "1", *FEW_FILES)
    assert "single: is a result itself (run.json)" in run(*scan, "single", code=1)


@case
def together():
    """Two processes on the same list leave one summary, of what both did."""
    for n in range(6):
        ball(f"in/{n}.ply", seed=n)
    process("--threads", "1")
    lock = os.open("out/2", os.O_RDONLY)
    fcntl.flock(lock, fcntl.LOCK_EX)
    told = process("--threads", "1", code=2)
    assert "6 inputs, 5 done before, 0 failed, 1 open" in told and "agrisee: open: in/2.ply: out/2: another process" in told
    with open("out/summary.csv", encoding="utf-8") as file:
        assert 'in/2.ply,2,open,,,,,"out/2: another process works' in file.read()
    os.close(lock)
    assert "6 inputs, 6 done before, 0 failed:" in process("--threads", "1")
    for _ in range(3):
        shutil.rmtree("out")
        words = [AGRISEE, "process", "in/*.ply", "-o", "out", "--viewpoint", "0,0,0", *FEW_FILES, "--threads", "1"]
        both = [subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) for _ in range(2)]
        told = [one.communicate()[0] for one in both]
        assert all("6 inputs" in text and " 0 failed" in text for text in told), told
        assert 0 in [one.returncode for one in both] and {one.returncode for one in both} <= {0, 2}, told
        with open("out/summary.csv", encoding="utf-8") as file:
            assert file.read().count(",ok,1,") == 6, told


@case
def shards():
    """Shards that saw different lists are not merged."""
    def shard(text, code=0):
        return process("--shard", text, code=code)

    def merged(code=0):
        return run("merge", "out", code=code), run("merge", "out", "--unfinished").strip()

    for name in "abd":
        ball(f"in/{name}.ply")
    shard("1/2")
    ball("in/c.ply")
    shard("2/2")
    told, left = merged(code=2)
    assert "not seen the same list" in told and "Run shards 1 again" in told and left == "1", (told, left)
    assert not os.path.exists("out/summary.csv")
    shard("1/2")
    assert "4 results of 2 shards, 0 failed" in merged()[0] and merged()[1] == ""
    with open("out/summary.csv", encoding="utf-8") as file:
        assert [line.split(",")[0] for line in file] == ["input", *(f"in/{name}.ply" for name in "abcd")]
    # A list may shrink, and a shard have no input.
    for name in "cd":
        os.remove(f"in/{name}.ply")
    shard("2/2")
    assert "Run shards 1 again" in merged(code=2)[0]
    shard("1/2")
    assert "2 results of 2 shards" in merged()[0]
    for index in 1, 2:
        os.remove(f"out/summary-{index}-of-2.csv")
        shard(f"{index}/3")
    shard("3/3")
    assert "2 results of 3 shards" in merged()[0]
    ball("in/c.ply")
    shard("1/3")
    shard("2/3")
    assert merged(code=2)[1] == "3", merged(code=2)
    shard("3/3")
    assert "3 results of 3 shards" in merged()[0]
    # The whole list replaces those of shards, another list does not.
    shutil.copytree("out", "whole")
    ball("in/d.ply")
    run("process", "in/d.ply", "in/a.ply", "-o", "whole", "--viewpoint", "0,0,0", *FEW_FILES)
    assert "3 results of 3 shards" in run("merge", "whole")
    run("process", "in/*.ply", "-o", "whole", "--viewpoint", "0,0,0", *FEW_FILES)
    assert "holds no summary of a shard" in run("merge", "whole", code=2)
    os.remove("in/d.ply")
    # Summaries of older versions do not tell the list: but no input may be there twice.
    for index in 1, 2, 3:
        with open(f"out/summary-{index}-of-3.csv", encoding="utf-8") as file:
            lines = [line.rsplit(",", 1)[0] + "\n" for line in file]
        with open(f"out/summary-{index}-of-3.csv", "w", encoding="utf-8") as file:
            file.writelines(lines)
    assert "3 results of 3 shards" in merged()[0]
    shutil.copy("out/summary-1-of-3.csv", "out/summary-3-of-3.csv")
    assert merged(code=2)[1] == "1,3"
    shutil.copy("out/summary-1-of-3.csv", "out/summary-2-of-3.csv")
    with open("out/summary-3-of-3.csv", "w", encoding="utf-8") as file:
        file.writelines(lines[:1])
    assert merged(code=2)[1] == "1,2"


@case
def renamed():
    """What older lists left behind does not count, nor does what is gone."""
    needs_sqlite()
    for name in "ab":
        ball(f"in/row_1/{name}/c.ply")
    ball("in/row_2/c/c.ply")
    words = ["-o", "out", "--viewpoint", "0,0,0", *FEW_FILES]

    def stored(database):
        connection = sqlite3.connect(database)
        try:
            return connection.execute('SELECT "row", input, status FROM scans ORDER BY input').fetchall()
        finally:
            connection.close()

    run("process", "in/*/*/*.ply", *words)
    run("merge", "out", "--db", "s.sqlite")
    # Under another path the same result is kept, and knows it.
    os.rename("in", "season")
    assert "3 inputs, 3 done before" in run("process", "season/*/*/*.ply", *words)
    assert "left out" not in run("merge", "out", "--db", "s.sqlite")
    expected = [("1", "season/row_1/a/c.ply", "ok"), ("1", "season/row_1/b/c.ply", "ok"), ("2", "season/row_2/c/c.ply", "ok")]
    assert stored("s.sqlite") == expected, stored("s.sqlite")
    # With another name it gets another folder, and the old one is left out.
    os.rename("season/row_1/b", "season/row_1/d")
    run("process", "season/*/*/*.ply", *words)
    expected[1] = ("1", "season/row_1/d/c.ply", "ok")
    for database in "s.sqlite", "new.sqlite":
        told = run("merge", "out", "--db", database)
        assert "left out; its input season/row_1/b/c.ply is gone, and no list names it" in told, told
        assert stored(database) == expected, stored(database)
        told = run("merge", ".", "--db", database)  # the list in a folder below counts, too
        assert "left out; its input season/row_1/b/c.ply is gone" in told and stored(database) == expected, told
    # The same results under another path are the same scans: where the old one is gone, they get the new one.
    os.makedirs("moved")
    shutil.copy("new.sqlite", "moved/s.sqlite")
    told = run("merge", "out", "--db", "moved/s.sqlite")
    assert "0 scans added, 0 replaced, 0 were there, 3 moved" in told and stored("moved/s.sqlite") == expected, told
    assert "0 scans added, 0 replaced, 3 were there:" in run("merge", "out", "--db", "moved/s.sqlite")
    # Failures move, too.
    with open("in2.ply", "w", encoding="utf-8") as file:
        file.write("ply\ndamaged\n")
    run("process", "in2.ply", "season/row_1/a/c.ply", "-o", "first", "--viewpoint", "0,0,0", *FEW_FILES, code=2)
    run("merge", "first", "--db", "f.sqlite")
    os.rename("first", "second")
    told = run("merge", "second", "--db", "f.sqlite")
    assert "0 were there, 1 moved, 1 without a result" in told and len(stored("f.sqlite")) == 2, told
    # Copies count twice, which is told; without one of them they do not.
    shutil.copytree("out", "copy")
    told = run("merge", "out", "copy", "--db", "new.sqlite")
    assert "3 scans added" in told and "3 scans are in the database twice, such as " in told, told
    shutil.rmtree("copy")
    told = run("merge", "out", "--db", "new.sqlite")
    assert "3 removed" in told and "twice" not in told and stored("new.sqlite") == expected, told
    # Line breaks in names are blanks in a summary.
    ball("lines/a\nb.ply")
    ball("lines/c.ply")
    run("process", "lines/*.ply", "-o", "broken", "--viewpoint", "0,0,0", *FEW_FILES)
    assert "2 scans added" in run("merge", "broken", "--db", "lines.sqlite")
    # A list of other inputs leaves nothing out.
    ball("more/e.ply")
    ball("more/f.ply", radius=0.025)
    run("process", "more/*.ply", *words)
    assert "2 scans added" in run("merge", "out", "--db", "s.sqlite") and len(stored("s.sqlite")) == 5
    # What is listed and gone is named, and stays in the database.
    shutil.rmtree("out/f")
    assert "out/f: is listed as ok, but its result is gone" in run("merge", "out", "--db", "s.sqlite", code=2)
    assert len(stored("s.sqlite")) == 5
    assert "1 scans added" not in run("merge", "out", "--db", "fewer.sqlite", code=2) and len(stored("fewer.sqlite")) == 4


@case
def places():
    """Row and date are the last ones in a path; what regular expressions cannot do is told at once."""
    needs_sqlite()
    paths = {"2025-01-01_backup/2026-06-03/row_07/a": ("7", "2026-06-03"), "2026-06-10/row_7/b": ("7", "2026-06-10"),
             "20260610/20260231/row_1/row_010b/c": ("10b", "2026-06-10"), "2024-02-29/row_0/d": ("0", "2024-02-29"),
             "20260610123/2026-06-311/e": ("", None), "2026-02-29/Row 12/f": ("12", None),
             "2026-03-01/row12plant3": ("12", "2026-03-01"), "2026-03-01/row-13c_plant3": ("13c", "2026-03-01")}
    for path in paths:
        ball(f"in/{path}.ply")
    run("process", *(f"in/{path}.ply" for path in paths), "-o", "out", "--viewpoint", "0,0,0", *FEW_FILES)
    told = run("merge", "out", "--db", "s.sqlite")
    assert "paths with two dates: 1, such as 'in/2025-01-01_backup/2026-06-03/row_07/a.ply', of which 2026-06-03" in told, told
    connection = sqlite3.connect("s.sqlite")
    for path, (row, date) in paths.items():
        got = connection.execute('SELECT "row", date, substr(time, 1, 10) FROM scans WHERE input = ?', [f"in/{path}.ply"]).fetchone()
        assert got[:2] == (row, date or got[2]), (path, got)
    connection.close()

    def merged(*words, code=0):
        begin = time.time()
        out = run("merge", "out", "--db", "t.sqlite", *words, code=code)
        assert time.time() - begin < 5, words
        return out

    for pattern in "(([a-z_0-9/.-]+)+)$x", "((a|ab|b|[a-z])*)*=", "(.*)(.*)(.*)(.*)(.*)(.*)(.*)(.*)(.*)(.*)x{3}y":
        assert "is in the path of no input" in merged("--row", pattern), pattern
    assert "references to groups" in merged("--row", r"(a)\1", code=1)
    assert "--date: '" in merged("--date", "((((a{1,999}){1,999}){1,999}){1,999})", code=1)
    merged("--date", r"/(\d+)[_-](\d\d)", "--row", "row.0*([0-9]+)")
    connection = sqlite3.connect("t.sqlite")
    assert ("7", "2026-06") in connection.execute('SELECT "row", date FROM scans').fetchall()
    connection.close()
    # Numbers in dates, and in rows, are in their order.
    for week, row in (("week9", "b10"), ("week10", "b9"), ("week10", "7")):
        ball(f"in/{week}/{row}/g.ply")
    run("process", "in/week*/*/g.ply", "-o", "weeks", "--viewpoint", "0,0,0", *FEW_FILES)
    run("merge", "weeks", "--db", "w.sqlite", "--date", "/(week[0-9]+)/", "--row", "/([b0-9]+)/g")
    assert "in 2 scans on week10, the last of 2 dates" in run("season", "w.sqlite", "-o", "w.html")
    with open("w.html", encoding="utf-8") as file:
        page = file.read()
    for words in (["week9", "week10"], ["7", "b9", "b10"]):
        places = [re.search(f">{word}</t[hd]>", page).start() for word in words]
        assert places == sorted(places), (words, places)


@case
def database():
    needs_sqlite()
    for n, name in enumerate(["2026-05-01/row_2/p1", "2026-05-01/row_10/p1", "20260601/row_2/p1"]):
        ball(f"in/{name}.ply", radius=0.02 + 0.005 * n)
    with open("in/20260601/row_2/p2.ply", "w", encoding="utf-8") as file:
        file.write("ply\ndamaged\n")
    scan = ["process", "in/*/*/*.ply", "-o", "out", "--viewpoint", "0,0,0", *FEW_FILES]
    run(*scan, code=2)
    assert "3 scans added, 0 replaced, 0 were there, 1 without a result" in run("merge", "out", "--db", "s.sqlite")
    assert "0 scans added, 0 replaced, 3 were there, 1 without a result" in run("merge", "out", "--db", "s.sqlite")

    def ask(question):
        connection = sqlite3.connect("s.sqlite")
        try:
            return connection.execute(question).fetchall()
        finally:
            connection.close()

    assert ask('SELECT date, "row", status FROM scans ORDER BY input') == [
        ("2026-05-01", "10", "ok"), ("2026-05-01", "2", "ok"), ("2026-06-01", "2", "ok"), ("2026-06-01", "2", "failed")]
    assert "bad PLY header" in ask("SELECT message FROM scans WHERE status = 'failed'")[0][0]
    for folder, in ask("SELECT folder FROM scans WHERE status = 'ok'"):  # every value is that of the files
        with open(folder + "/fruits.json", encoding="utf-8") as file:
            fruits = json.load(file)
        rows = ask("SELECT fruit.id, x, y, z, diameter, mass, completeness, confidence, found_by FROM fruit "
                   f"JOIN scans ON scans.id = scan WHERE folder = '{folder}' ORDER BY fruit.id")
        assert len(fruits) == len(rows) == 1
        for f, row in zip(fruits, rows):
            assert row == (f["id"], *f["center_world"], row[4], f["mass"], f["completeness"], f["confidence"],
                           f["found_by"]) and abs(row[4] - 2 * sum(f["radii"]) / 3) < 1e-12, (f, row)
        with open(folder + "/run.json", encoding="utf-8") as file:
            told = json.load(file)
        got = ask("SELECT version, preset, json, time, seed FROM scans JOIN parameters ON parameters.id = parameters "
                  f"WHERE folder = '{folder}'")[0]
        version = ask(f"SELECT version FROM versions WHERE id = {got[0]}")[0][0]
        assert (version, got[1], got[3], got[4]) == (told["version"], told["preset"], told["time"], str(told["seed"]))
        assert json.loads(got[2]) == told["parameters"]
    assert ask("SELECT count(*) FROM parameters") == [(1,)]
    # What changed is replaced, once; the failure becomes a result.
    ball("in/20260601/row_2/p2.ply", radius=0.02)
    ball("in/2026-05-01/row_2/p1.ply", radius=0.03)
    run(*scan)
    assert "0 scans added, 2 replaced, 2 were there" in run("merge", "out", "--db", "s.sqlite")
    assert ask("SELECT count(*), count(DISTINCT scan) FROM fruit") == [(4, 4)]
    assert ask("SELECT count(*) FROM scans WHERE status != 'ok'") == [(0,)]
    # What an older list left behind goes.
    shutil.copytree("out/p2", "out/old")
    assert "1 scans added" in run("merge", "out/old", "--db", "s.sqlite")
    assert "out/old: left out; in/20260601/row_2/p2.ply is now in p2" in run("merge", "out", "--db", "s.sqlite")
    assert ask("SELECT count(*) FROM scans") == [(4,)]
    shutil.rmtree("out/old")
    # What a stopped list left open is told of.
    os.makedirs("stopped")
    shutil.copytree("out/p2", "stopped/p2")
    with open("out/summary.csv", encoding="utf-8") as file, open("stopped/summary.csv", "w", encoding="utf-8") as stopped:
        stopped.write(file.read().replace(",ok,", ",open,"))
    told = run("merge", "stopped", "--db", "o.sqlite", code=2)
    assert "1 scans added, 0 replaced, 0 were there, 3 without a result" in told and "3 inputs are open" in told, told
    assert "3 without a result" in run("season", "o.sqlite", "-o", "o.html")
    # A result that cannot be read does not stop the others, and what was there of it stays.
    shutil.copytree("out", "broken")
    for folder in os.listdir("broken"):
        if os.path.isdir("broken/" + folder) and folder.endswith("row_10_p1"):
            os.truncate(f"broken/{folder}/fruits.json", 40)
    told = run("merge", "broken", "--db", "b.sqlite", code=2)
    assert "3 scans added" in told and "left out: broken/" in told and "fruits.json" in told, told
    shutil.rmtree("broken")
    os.makedirs("nothing")
    assert "nothing: holds no result" in run("merge", "nothing", "--db", "n.sqlite", code=2) and not os.path.exists("n.sqlite")
    assert "has no group" in run("merge", "out", "--db", "b.sqlite", "--row", "p[0-9]", code=1)
    assert "'block([0-9])' is in the path of no input, such as 'in/" in run("merge", "out", "--db", "b.sqlite", "--row", "block([0-9])")
    # A folder that is named twice is one; other rules for rows change what is there.
    assert "0 scans added, 0 replaced, 4 were there" in run("merge", "out", "out/", "--db", "s.sqlite")
    assert "0 scans added, 3 replaced, 1 were there" in run("merge", "out", "--db", "s.sqlite", "--row", "p([0-9])")
    assert ask('SELECT DISTINCT "row" FROM scans ORDER BY 1') == [("1",), ("2",)]
    assert "0 scans added, 3 replaced, 1 were there" in run("merge", "out", "--db", "s.sqlite")
    # Other rules for rows and dates; views of a scan.
    run("make-truss", "--total", "3", "--hidden", "0", "--seed", "1", "-o", "t")
    run("scan", "t", "-o", "lone/Block-B", "--max-views", "2", *FEW_FILES)
    run("merge", "lone", "--db", "s.sqlite", "--row", "Block-([A-Z])")
    assert ask("SELECT \"row\", date = substr(time, 1, 10), views FROM scans WHERE input = ''") == [("B", 1, 2)]
    assert ask("SELECT count(*), sum(points_new) > 0 FROM views") == [(2, 1)]
    page = "s.html"
    assert "the last of 3 dates; in all 5 scans, 0 without a result" in run("season", "s.sqlite", "-o", page)
    with open(page, encoding="utf-8") as file:
        text = file.read()
    for told in "5 scans of 3 rows", "2026-05-01", "<td>10</td>", "2 sets of parameters":
        assert told in text, (told, text)
    assert text.index("<td>2</td>") < text.index("<td>10</td>") and "script" not in text
    assert "use --force" in run("season", "s.sqlite", "-o", page, code=1)
    assert "is the database" in run("season", "s.sqlite", "-o", "./s.sqlite", "--force", code=1)
    assert "is not a regular expression" in run("merge", "out", "--db", "s.sqlite", "--row", "(", code=1)
    assert "no such file" in run("season", "none.sqlite", "-o", "x.html", code=2)
    with open("other.sqlite", "w", encoding="utf-8") as file:
        file.write("nothing" * 200)
    assert "other.sqlite: " in run("season", "other.sqlite", "-o", "x.html", code=2)
    sqlite3.connect("foreign.sqlite").execute("CREATE TABLE t (a)").connection.close()
    shutil.copy("s.sqlite", "later.sqlite")
    sqlite3.connect("later.sqlite").execute("PRAGMA user_version = 99").connection.close()
    for database, told in [("foreign.sqlite", "database of something else"), ("later.sqlite", "another version of AgriSEE"),
                           ("out", "out: is a folder")]:
        assert told in run("merge", "out", "--db", database, code=2), database
        assert told in run("season", database, "-o", "x.html", code=2), database


@case
def million():
    """The page of a million fruit, and how fast results go into a database."""
    needs_sqlite()
    ball("in/a.ply")
    run("process", "in/a.ply", "-o", "one", "--viewpoint", "0,0,0", *FEW_FILES)
    count = 1000
    for n in range(count):
        os.makedirs(f"many/r{n}")
        for name in "run.json", "fruits.json", "views.csv":
            shutil.copy("one/" + name, f"many/r{n}/{name}")
    begin = time.time()
    run("merge", "many", "--db", "s.sqlite")
    seconds = time.time() - begin
    print(f"{count / seconds:.0f} results a second")
    connection = sqlite3.connect("s.sqlite")
    assert connection.execute("SELECT count(*) FROM fruit").fetchone() == (count,)
    connection.executescript("""
        DELETE FROM fruit; DELETE FROM scans;
        WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n WHERE i < 49999)
          INSERT INTO scans(id, folder, content, status, message, input, "row", date)
          SELECT i + 1, i, '', 'ok', '', '', i % 40 + 1, date('2026-04-01', '+' || (i / 2500 * 7) || ' days') FROM n;
        WITH RECURSIVE k(j) AS (SELECT 1 UNION ALL SELECT j + 1 FROM k WHERE j < 20)
          INSERT INTO fruit(scan, id, truss, points, found_by, x, y, z, diameter, mass, ripeness)
          SELECT s.id, j, 1, 9, 'dbscan', 0, 0, 0, 0.0405 + 0.001 * (j % 20), 0.1, CASE j % 2 WHEN 0 THEN 'green' ELSE 'red' END
          FROM scans s, k;""")
    connection.close()
    begin = time.time()
    assert "50000 fruit in 2500 scans on 2026-08-12, the last of 20 dates; in all 50000 scans" in run(
        "season", "s.sqlite", "-o", "s.html")
    page = time.time() - begin
    print(f"page of a million fruit: {page:.2f} s")
    assert page < 10 and seconds < 20  # some ten times what it takes
    with open("s.html", encoding="utf-8") as file:
        text = file.read()
    assert "50&#8239;000 fruit in 2&#8239;500 scans on the last date, 2026-08-12. In all 50&#8239;000 scans" in text
    # Fruit of several dates, which may be the same, are not added up.
    assert "<tr><td>6</td><td>2026-08-12</td><td>62</td><td></td><td>1&#8239;240</td>" in text, text[:12000]
    row = "<tr><td>2026-04-08</td><td>2&#8239;500</td><td></td><td>50&#8239;000</td><td>20.0</td><td>50.0</td>"
    assert row in text and "<td>42 to 58</td><td>5000.0</td><td>50</td>" in text, text[:6000]


shutil.rmtree(WORK, ignore_errors=True)
os.makedirs(WORK)
os.chdir(WORK)
CASES[CASE]()
