#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A scan that is killed, or runs out of disk, loses nothing: resumed, it ends with the bytes of one that was not.

Usage: survive.py AGRISEE WORKDIR kill [COUNT [SEED]]   kill -9 at COUNT random moments, half of them while resuming
       survive.py AGRISEE WORKDIR full                  file systems of growing sizes, each filled to the brim
Exits with 77 where this machine lets nobody limit the size of files or mount a small file system.
"""
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

AGRISEE, WORK, MODE = os.path.abspath(sys.argv[1]), sys.argv[2], sys.argv[3]
SCAN = ["t/scene.yaml", "--noise", "rough", "--seed", "5", "--max-views", "6", "--threads", "2"]


def fail(message):
    sys.exit("FAILED: " + message)


def run(*args, **more):
    return subprocess.run([AGRISEE, *args], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, **more)


def must(*args):
    done = run(*args)
    if done.returncode != 0:
        fail(f"agrisee {' '.join(args)}: exit {done.returncode}\n{done.stderr}")


def without_times(name, data):
    """The bytes of a file, the times in it taken away."""
    if name == "run.json":
        return re.sub(rb'"seconds": \{.*?\}|"time": "[^"]*"', b"", data, flags=re.S)
    if name == "views.csv":
        return re.sub(rb",[^,\n]*\n", b"\n", data)  # the last column is plan_s
    if name == "report.html":
        return re.sub(rb'"seconds":\{.*?\}|"plan_seconds":[^,}]*|"time":"[^"]*"', b"", data, flags=re.S)
    return data


def contents(folder):
    """Every file of a folder, hidden ones too."""
    found = {}
    for at, _, names in os.walk(folder):
        for name in names:
            with open(os.path.join(at, name), "rb") as file:
                found[os.path.relpath(os.path.join(at, name), folder)] = without_times(name, file.read())
    return found


def compare(folder, truth):
    got = contents(folder)
    if sorted(got) != sorted(truth):
        fail(f"{folder} holds {sorted(got)}, expected {sorted(truth)}")
    for name in truth:
        if got[name] != truth[name]:
            fail(f"{folder}/{name} differs from that of a scan that was not interrupted")


def check_intact(folder, truth, finished):
    """What an interrupted scan left: every file under its own name is whole."""
    for name, data in contents(folder).items():
        if re.search(r"(^|/)\.", name):
            if finished:
                fail(f"{folder}/{name} was left behind")
            continue
        if name == "views.csv":  # may tell of fewer views
            if not truth[name].startswith(data) or not data.endswith(b"\n"):
                fail(f"{folder}/{name} is torn")
        elif name == "cloud_raw.ply":
            head, body = data.split(b"end_header\n", 1)
            if len(body) != 16 * int(re.search(rb"element vertex (\d+)", head).group(1)):
                fail(f"{folder}/{name} is torn")
        elif data != truth[name]:
            fail(f"{folder}/{name} is torn, or differs from that of a scan that was not interrupted")


def kill_after(seconds, *args):
    """True when the scan was still running."""
    scan = subprocess.Popen([AGRISEE, *args], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        scan.wait(timeout=seconds)
    except subprocess.TimeoutExpired:
        scan.send_signal(signal.SIGKILL)
        scan.wait()
        return True
    if scan.returncode != 0:
        fail(f"agrisee {' '.join(args)}: exit {scan.returncode}")
    return False


def test_kill(count, seed, truth, seconds):
    draw = random.Random(seed)
    kills, with_views = 0, 0
    while kills < count:
        shutil.rmtree("r", ignore_errors=True)
        killed = kill_after(draw.uniform(0, seconds), "scan", *SCAN, "-o", "r")
        while killed and kills < count:
            kills += 1
            if not os.path.exists("r/scan.json"):  # nothing was begun
                check_intact("r", truth, False)
                must("scan", *SCAN, "-o", "r")
                break
            check_intact("r", truth, False)
            with_views += os.path.exists("r/views/0000.view")
            if draw.random() < 0.5:
                break
            killed = kill_after(draw.uniform(0, seconds), "scan", "--resume", "r")
        must("scan", "--resume", "r")
        compare("r", truth)
    print(f"{kills} kills, {with_views} of them after a view, in scans of {seconds:.1f} s: every scan ended alike")
    if count >= 8 and with_views == 0:
        fail("no kill fell between two views")


def test_damage(truth):
    """Records that are not what they should be are told of."""
    def expect(pattern, *args):
        done = run("scan", *args)
        if done.returncode not in (1, 2, 3) or not re.search(pattern, done.stderr):
            fail(f"agrisee scan {' '.join(args)}: exit {done.returncode}, not '{pattern}':\n{done.stderr}")

    shutil.rmtree("r", ignore_errors=True)
    expect("scan.json.*no such file", "--resume", "r")
    expect("exclude", "--resume", "whole", "--seed", "3")
    shutil.copytree("whole", "r")
    for name in ("run.json", "report.html"):
        os.remove(f"r/{name}")
    expect("not finished.*--resume", *SCAN, "-o", "r")
    for name in ("views.csv", "cloud.ply", "cloud_raw.ply", "fruits.json", "fruits.csv", "truss.png"):
        os.remove(f"r/{name}")
    expect("not finished.*--resume", *SCAN, "-o", "r")
    record = "r/views/0002.view"
    whole = open(record, "rb").read()
    for damaged in (whole[:-1], whole[:40], b"", whole[:1000] + bytes([whole[1000] ^ 1]) + whole[1001:]):
        open(record, "wb").write(damaged)
        expect("0002.view.*(damaged|not a view record)", "--resume", "r")
    open(record, "wb").write(whole.replace(b"view 1\n", b"view 2\n", 1))
    expect("0002.view.*version 1", "--resume", "r")
    shutil.copy("whole/views/0003.view", record)
    expect("0002.view.*another view", "--resume", "r")
    os.remove(record)  # taken again
    task = open("r/scan.json").read()
    open("r/scan.json", "w").write(task.replace('"seed": 5', '"seed": 6'))
    expect("another scan", "--resume", "r")
    open("r/scan.json", "w").write(task[:200])
    expect("scan.json.*JSON", "--resume", "r")
    open("r/scan.json", "w").write(task.replace('"format_version": 1', '"format_version": 7'))
    expect("scan.json.*version 1", "--resume", "r")
    open("r/scan.json", "w").write(task)
    shutil.copytree("t", "moved", dirs_exist_ok=True)
    scene = open("moved/scene.yaml").read()
    open("moved/scene.yaml", "w").write(scene + "# changed\n")
    expect("not the scene", "moved/scene.yaml", "--resume", "r")
    open("moved/scene.yaml", "w").write(scene)
    must("scan", "moved/scene.yaml", "--resume", "r")
    compare("r", truth)
    must("scan", "--resume", "r")  # finished: nothing is written
    must("scan", *SCAN, "-o", "r", "--force")
    compare("r", truth)


def in_small_file_system(size, scan):
    """A scan into s/r on a file system of so many bytes; then, made large, its resumption, copied to r. None where
    nobody may mount one."""
    script = f"""
mount -t tmpfs -o size={size} tmpfs s || exit 99
"$@" >/dev/null 2>err.txt; echo $? >code.txt
rm -rf left && cp -r s left && cp -r s/r left.r 2>/dev/null
mount -o remount,size=200m s || exit 99
if [ -e s/r/scan.json ]; then "$AGRISEE" scan --resume s/r >/dev/null 2>&1 || exit 98; else exit 0; fi
cp -r s/r r || exit 97
"""
    os.makedirs("s", exist_ok=True)
    for space in (["unshare", "-m"], ["unshare", "-Urm"]):
        for old in ("r", "left", "left.r", "err.txt", "code.txt"):
            shutil.rmtree(old, ignore_errors=True) if os.path.isdir(old) else os.path.exists(old) and os.remove(old)
        if not shutil.which("unshare"):
            return None
        done = subprocess.run([*space, "sh", "-c", script, "sh", AGRISEE, *scan], env={**os.environ, "AGRISEE": AGRISEE},
                              stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        if done.returncode in (97, 98):
            fail(f"a scan that ran out of {size} bytes could not be resumed: {done.returncode}")
        if done.returncode == 0 and os.path.exists("code.txt"):
            return int(open("code.txt").read()), open("err.txt").read()
    return None


def test_full(truth):
    total = sum(os.path.getsize(os.path.join(at, name)) for at, _, names in os.walk("whole") for name in names)
    failed = 0
    sizes = [8192] + [int(total * share) for share in (0.1, 0.25, 0.4, 0.55, 0.7, 0.8, 0.9, 0.97)]
    for size in sizes:
        outcome = in_small_file_system(size, ["scan", *SCAN, "-o", "s/r"])
        if outcome is None:
            print("no small file system can be mounted here")
            break
        code, error = outcome
        if code == 0:
            continue
        failed += 1
        if code not in (2, 3) or "No space left" not in error or "s/r" not in error:
            fail(f"a full file system of {size} bytes: exit {code}\n{error}")
        if os.path.isdir("left.r"):
            check_intact("left.r", truth, True)
        if os.path.isdir("r"):
            compare("r", truth)
        shutil.rmtree("left.r", ignore_errors=True)
        print(f"{size} bytes: exit {code}: {error.strip().splitlines()[0] if error.strip() else ''}")
    if failed == 0 and outcome is not None:
        fail("no file system was too small")

    # A limit on the size of a file needs no rights at all.
    largest = max(os.path.getsize(os.path.join("whole/views", name)) for name in os.listdir("whole/views"))
    for limit in (1000, largest - 1):
        shutil.rmtree("r", ignore_errors=True)
        done = run("scan", *SCAN, "-o", "r", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        if done.returncode not in (2, 3) or "File too large" not in done.stderr:
            fail(f"files of at most {limit} bytes: exit {done.returncode}\n{done.stderr}")
        if os.path.isdir("r"):
            check_intact("r", truth, True)
        if os.path.exists("r/scan.json"):
            must("scan", "--resume", "r")
            compare("r", truth)
    if failed == 0:
        sys.exit(77)


def main():
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    os.chdir(WORK)
    must("make-truss", "--total", "3", "--hidden", "0", "--seed", "1", "-o", "t")
    scene = open("t/scene.yaml").read()
    open("t/scene.yaml", "w").write(re.sub(r"height: *768", "height: 192", re.sub(r"width: *1024", "width: 256", scene)))
    begin = time.monotonic()
    must("scan", *SCAN, "-o", "whole")
    seconds = time.monotonic() - begin
    truth = contents("whole")
    if json.load(open("whole/run.json"))["views"] < 4:
        fail("too short a scan to be interrupted")
    if MODE == "kill":
        count = int(sys.argv[4]) if len(sys.argv) > 4 else 8
        test_kill(count, int(sys.argv[5]) if len(sys.argv) > 5 else 1, truth, seconds)
        test_damage(truth)
    else:
        test_full(truth)


main()
