# SPDX-License-Identifier: BSD-3-Clause
"""A season on a cluster: forty clouds by Slurm, with one that fails and one that is killed, and by GNU parallel.

  python3 cluster.py AGRISEE WORKDIR CASE       slurm or parallel; exit code 77: its programs are not installed

Slurm runs on this machine alone: munged, slurmctld and slurmd of this test's own, with all of their files in WORKDIR, on
ports that are free. slurmd has to be run by root.
"""
import getpass
import os
import random
import shutil
import signal
import socket
import sqlite3
import subprocess
import sys
import tempfile
import time

AGRISEE, CASE = os.path.abspath(sys.argv[1]), sys.argv[3]
WORK = os.path.join(os.path.abspath(sys.argv[2]), "cluster_" + CASE)
COUNT, FAILS, KILLED = 40, 17, 23  # numbers of the shards, from 1
SEASON = "season/2026-*/row_*/*.ply"


def skip(reason):
    print(f"SKIPPED: a season by {CASE} ({reason})")
    sys.exit(77)


def run(*words, code=0, environment=None):
    done = subprocess.run(words, capture_output=True, text=True, env=environment)
    assert done.returncode == code, (words, done.returncode, done.stdout, done.stderr)
    return done.stdout


def agrisee(*words, code=0):
    return run(AGRISEE, *words, code=code)


def make_season():
    """Forty small clouds, half a ball each, and one that is damaged; sorted, they are the shards 1 to 40."""
    rng = random.Random(1)
    names = [f"season/2026-0{5 + n // 20}-01/row_{n % 20 // 5 + 1}/plant_{n % 5}.ply" for n in range(COUNT)]
    for n, name in enumerate(sorted(names), 1):
        os.makedirs(os.path.dirname(name), exist_ok=True)
        with open(name, "w", encoding="utf-8") as file:
            if n == FAILS:
                file.write("ply\ndamaged\n")
                continue
            radius, points = 0.02 + 0.0002 * n, []
            while len(points) < 1500:
                p = [rng.gauss(0, 1) for _ in range(3)]
                length = sum(x * x for x in p) ** 0.5
                if p[1] < 0:  # the side towards the sensor
                    points.append([radius * x / length + c for x, c in zip(p, (0, 0.4, 0))])
            file.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(points) +
                       "".join(f"property float {a}\n" for a in "xyz") + "end_header\n" +
                       "".join("%.5f %.5f %.5f\n" % tuple(p) for p in points))
    return sorted(names)


def process(shard):
    return [AGRISEE, "process", SEASON, "-o", "results", "--shard", f"{shard}/{COUNT}", "--threads", "1", "--viewpoint",
            "0,0,0", "--quiet", "--no-picture", "--no-report"]


def times():
    """When each result was made."""
    return {d: os.stat(f"results/{d}/fruits.json").st_mtime_ns for d in os.listdir("results")
            if os.path.exists(f"results/{d}/fruits.json")}


def check_season(names):
    """One database with all results, whatever ran them."""
    agrisee("merge", "results", "--db", "season.sqlite")
    database = sqlite3.connect("season.sqlite")
    rows = database.execute('SELECT input, status, "row", date FROM scans ORDER BY input').fetchall()
    assert [row[0] for row in rows] == names, rows
    assert all(row[1] == "ok" for row in rows), rows
    assert rows[0][2:] == ("1", "2026-05-01") and rows[-1][2:] == ("4", "2026-06-01"), rows
    fruit = database.execute("SELECT count(*), min(diameter), max(diameter) FROM fruit").fetchone()
    assert fruit[0] == COUNT and 0.039 < fruit[1] < 0.043 and 0.053 < fruit[2] < 0.058, fruit
    database.close()
    assert "0 scans added, 0 replaced, 40 were there" in agrisee("merge", "results", "--db", "season.sqlite")
    agrisee("season", "season.sqlite", "-o", "season.html")
    with open("season.html", encoding="utf-8") as file:
        page = file.read()
    assert "20 fruit in 20 scans on the last date, 2026-06-01. In all 40 scans of 4 rows on 2 dates" in page, page[:3000]


def mend(names):
    """Replace the damaged cloud by its neighbour."""
    shutil.copy(names[FAILS], names[FAILS - 1])


def by_parallel():
    if not shutil.which("parallel"):
        skip("parallel is not installed")
    names = make_season()
    command = ["parallel", "--will-cite", "-j", "2"]
    one = " ".join(f"'{w}'" for w in process("{}"))
    subprocess.run([*command, one, ":::", *map(str, range(1, COUNT + 1))], capture_output=True, check=False)
    assert agrisee("merge", "results", "--unfinished").strip() == str(FAILS)
    before = times()
    assert len(before) == COUNT - 1, before
    mend(names)
    run(*command, one, ":::", *map(str, range(1, COUNT + 1)))  # all again: what is done is skipped
    assert {d: t for d, t in times().items() if d in before} == before, "something was done twice"
    assert agrisee("merge", "results", "--unfinished") == ""
    check_season(names)


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class Cluster:
    """Slurm on this machine."""

    def __init__(self):
        # Sockets have short paths; munged wants a folder that only its user can write, below folders of which that is true.
        self.folder = tempfile.mkdtemp(prefix="agrisee-slurm-", dir="/run" if os.access("/run", os.W_OK) else None)
        os.chmod(self.folder, 0o755)
        self.processes = []
        name, user = socket.gethostname().split(".")[0], getpass.getuser()
        control, node = free_ports(2)
        path = lambda p: os.path.join(self.folder, p)
        with open(path("key"), "wb") as file:
            file.write(os.urandom(1024))
        os.chmod(path("key"), 0o600)
        os.makedirs(path("state"))
        os.makedirs(path("spool"))
        with open(path("cgroup.conf"), "w", encoding="utf-8") as file:
            file.write("CgroupPlugin=cgroup/v1\nCgroupAutomount=no\n")
        with open(path("slurm.conf"), "w", encoding="utf-8") as file:
            file.write(f"""ClusterName=agrisee
SlurmctldHost={name}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={path('munge.socket')}
CryptoType=crypto/munge
SlurmctldPort={control}
SlurmdPort={node}
StateSaveLocation={path('state')}
SlurmdSpoolDir={path('spool')}
SlurmctldPidFile={path('slurmctld.pid')}
SlurmdPidFile={path('slurmd.pid')}
SlurmctldLogFile={path('slurmctld.log')}
SlurmdLogFile={path('slurmd.log')}
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SlurmdParameters=config_overrides
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=sched_min_interval=20000,batch_sched_delay=0,sched_interval=1,bf_interval=1
NodeName={name} NodeAddr=127.0.0.1 CPUs=8 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""")
        self.environment = {**os.environ, "SLURM_CONF": path("slurm.conf")}
        self.start("munged", "--foreground", "--force", f"--key-file={path('key')}", f"--socket={path('munge.socket')}",
                   f"--pid-file={path('munged.pid')}", f"--log-file={path('munged.log')}",
                   f"--seed-file={path('munged.seed')}")
        self.wait(lambda: os.path.exists(path("munge.socket")), "munged")
        self.start("slurmctld", "-D", "-i")
        self.start("slurmd", "-D", "-N", name)
        try:
            self.wait(lambda: "idle" in self.ask("sinfo", "-h", "-o", "%T"), "slurmd")
        except AssertionError as error:
            self.stop()
            if "cgroup" not in str(error):
                raise
            skip("slurmd cannot use the control groups of this machine")

    def start(self, program, *words):
        with open(os.path.join(self.folder, program + ".out"), "wb") as out:
            self.processes.append(subprocess.Popen(["/usr/sbin/" + program, *words], stdout=out, stderr=out,
                                                   env=self.environment))

    def ask(self, *words):
        return subprocess.run(words, capture_output=True, text=True, env=self.environment, check=False).stdout

    def wait(self, done, what, seconds=60):
        end = time.time() + seconds
        while not done():
            if time.time() > end or any(p.poll() is not None for p in self.processes):
                logs = [f for f in os.listdir(self.folder) if f.endswith((".out", ".log"))]
                told = [f + ":\n" + open(os.path.join(self.folder, f), errors="replace").read()[-2000:] for f in logs]
                raise AssertionError(f"{what} does not answer\n" + "\n".join(told))
            time.sleep(0.1)

    def stop(self):
        for process in reversed(self.processes):
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
        for process in self.processes:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
        shutil.rmtree(self.folder, ignore_errors=True)

    def submit(self, array):
        """Run season.sh for some shards, and wait for the end."""
        begin = time.time()
        job = run("sbatch", "--parsable", f"--array={array}", "season.sh", environment=self.environment).strip()
        self.wait(lambda: not self.ask("squeue", "-h", "-j", job).strip(), f"job {job}", 120)
        print(f"shards {array}: {time.time() - begin:.1f} s")


def by_slurm():
    for program in "munged", "slurmctld", "slurmd":
        if not os.access("/usr/sbin/" + program, os.X_OK):
            skip("slurm-wlm and munge are not installed")
    if os.geteuid() != 0:
        skip("slurmd has to be run by root")
    names = make_season()
    os.rename(names[KILLED - 1], "kept.ply")  # who reads this cloud waits, until it is killed
    os.mkfifo(names[KILLED - 1])
    words = " ".join(f"'{w}'" if "*" in w else w for w in process("$SLURM_ARRAY_TASK_ID"))
    with open("season.sh", "w", encoding="utf-8") as file:
        file.write(f"""#!/bin/bash
#SBATCH --cpus-per-task=1 --output=/dev/null
if [ $SLURM_ARRAY_TASK_ID = {KILLED} ] && [ -e kept.ply ]; then
  {words} & scan=$!
  until grep -qs started results/*/job.json; do sleep 0.05; done
  kill -9 $scan
  wait $scan
  exit 1
fi
exec {words}
""")
    cluster = Cluster()
    try:
        cluster.submit(f"1-{COUNT}")
        left = agrisee("merge", "results", "--unfinished").strip()
        assert left == f"{FAILS},{KILLED}", left
        agrisee("merge", "results", code=2)
        before = times()
        mend(names)
        os.rename("kept.ply", names[KILLED - 1])
        cluster.submit(left)
        assert agrisee("merge", "results", "--unfinished") == ""
        cluster.submit(f"1,{FAILS},{KILLED},{COUNT}")  # nothing is left to do
        again = times()
        assert {d: t for d, t in again.items() if d in before} == before, "something was done twice"
        assert len(again) == COUNT
        with open("results/summary-1-of-40.csv", encoding="utf-8") as file:
            assert ",ok,1," in file.read()
        check_season(names)
    finally:
        cluster.stop()


shutil.rmtree(WORK, ignore_errors=True)
os.makedirs(WORK)
os.chdir(WORK)
{"parallel": by_parallel, "slurm": by_slurm}[CASE]()
