# SPDX-License-Identifier: BSD-3-Clause
"""The command as a user meets it in a shell: completion, --version, doctor, suggestions, the progress line.

  python3 shell.py AGRISEE WORKDIR CASE       a case of CASES, below; exit code 77: the shell is not installed
"""
import os
import pty
import re
import select
import shutil
import struct
import subprocess
import sys
import termios
import time
import fcntl

AGRISEE, WORK, CASE = os.path.abspath(sys.argv[1]), os.path.join(sys.argv[2], sys.argv[3]), sys.argv[3]
CASES = {}


def case(function):
    CASES[function.__name__] = function
    return function


def run(*words, code=0):
    done = subprocess.run([AGRISEE, *words], capture_output=True, text=True)
    assert done.returncode == code, (words, done.returncode, done.stderr)
    return done.stdout, done.stderr


def script(shell):
    text = run("completion", shell)[0]
    with open("script." + shell, "w", encoding="utf-8") as file:
        file.write(text)
    return text


def needs(shell):
    if not shutil.which(shell):
        print(f"SKIPPED: completion in {shell} ({shell} is not installed)")
        sys.exit(77)


def small_truss():
    run("make-truss", "--total", "3", "--hidden", "0", "--seed", "1", "-o", "t")
    with open("t/scene.yaml", encoding="utf-8") as file:
        text = file.read()
    with open("t/scene.yaml", "w", encoding="utf-8") as file:
        file.write(text.replace("width: 1024", "width: 512").replace("height: 768", "height: 384"))


def on_terminal(words, columns, environment=None):
    """What a program writes to a terminal of this width."""
    pid, terminal = pty.fork()
    if pid == 0:
        os.environ.update({"TERM": "xterm", **(environment or {})})
        fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        os.execvp(words[0], words)
    out = b""
    while True:
        try:
            got = os.read(terminal, 65536)
        except OSError:  # how Linux tells that the other end is closed
            break
        if not got:
            break
        out += got
    assert os.waitpid(pid, 0)[1] == 0, out
    return out.decode()


@case
def completion_bash():
    script("bash")

    def words(*line):
        test = ('source script.bash; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _agrisee; printf "%s\\n" "${COMPREPLY[@]}"')
        done = subprocess.run(["bash", "-c", test, "bash", "agrisee", *line], capture_output=True, text=True, check=True)
        assert not done.stderr, done.stderr
        return done.stdout.split()

    commands = re.findall(r"^  ([a-z][a-z-]+) ", run("--help")[0].split("Subcommands:")[1].split("Examples")[0], re.M)
    assert words("") == commands and len(commands) > 10, (words(""), commands)
    assert words("pro") == ["process"]
    assert words("scan", "--pre") == ["--preset"]
    assert words("scan", "--preset", "") == ["default", "paper", "see"]
    assert words("scan", "--preset", "=", "pa") == ["paper"]
    assert words("experiment", "--presets", "paper,d") == ["paper,default"]
    assert words("completion", "f") == ["fish"]
    assert words("scan", "-o", "") == []  # then bash completes names of files
    for command in commands:  # all options that --help lists, and no others
        told = set(re.findall(r"(?<![\w-])(--[a-z][a-z-]*|-[a-z])(?=[\s,]|$)",
                              "\n".join(re.findall(r"^  (-.*?)(?:  |$)", run(command, "--help")[0], re.M))))
        assert told and set(words(command, "-")) == told, (command, set(words(command, "-")) ^ told)


@case
def completion_fish():
    needs("fish")
    script("fish")
    environment = {**os.environ, "HOME": os.getcwd()}

    def words(line):
        done = subprocess.run(["fish", "-c", f"source script.fish; complete -C '{line}'"], capture_output=True, text=True,
                              check=True, env=environment)
        assert not done.stderr, done.stderr
        return [line.split("\t")[0] for line in done.stdout.splitlines()]

    assert words("agrisee pro") == ["process"]
    assert words("agrisee scan --pre") == ["--preset"]
    assert words("agrisee scan --preset ") == ["default", "paper", "see"]
    assert words("agrisee completion ") == ["bash", "fish", "zsh"]
    open("cloud.ply", "w", encoding="utf-8").close()
    assert words("agrisee process cl") == ["cloud.ply"]


@case
def completion_zsh():
    needs("zsh")
    script("zsh")
    pid, terminal = pty.fork()
    if pid == 0:
        fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", 50, 200, 0, 0))
        os.environ.update({"TERM": "xterm", "HOME": os.getcwd()})
        os.execvp("zsh", ["zsh", "-f", "-i"])

    def until(pattern):
        got, end = "", time.time() + 60
        while not re.search(pattern, got):
            assert time.time() < end, got
            if select.select([terminal], [], [], 1)[0]:
                got += re.sub(r"\x1b(\[[0-9;?]*[a-zA-Z]|[=>])", "", os.read(terminal, 65536).decode(errors="replace"))
        return got

    def complete(line, pattern):
        os.write(terminal, b"\x15" + line.encode() + b"\t")
        return until(pattern)

    os.write(terminal, b"autoload -Uz compinit; compinit -D -u; source ./script.zsh; LISTMAX=0; echo rea''dy\n")
    until(r"\nready")
    complete("agrisee pro", r"agrisee process ")
    complete("agrisee scan --pres", r"--preset=?")
    complete("agrisee scan --preset p", r"--preset paper ")
    complete("agrisee completion f", r"fish ")
    os.write(terminal, b"\x15exit\n")
    os.waitpid(pid, 0)


@case
def version():
    text = run("--version")[0].splitlines()
    assert re.fullmatch(r"agrisee \d+\.\d+\.\d+", text[0]), text
    told = " ".join(text)
    for fact in r"built: +\S+ \d+", r"sources: +\S", r"Eigen \d+\.\d", r"nanoflann \d", r"yaml-cpp \d", r"SQLite":
        assert re.search(fact, told), (fact, told)


@case
def doctor():
    assert "To check a workcell" in run("doctor")[0]
    small_truss()
    good = run("doctor", "t")[0]
    assert "0 wrong, 0 to look at" in good and "3 fruit, all inside" in good, good
    assert re.search("ok +robot.gripper: not given", good), good
    assert re.search(r"ok +sensor: 512 x 384 pixels over 70 x 55 degrees", good), good
    with open("t/scene.yaml", encoding="utf-8") as file:
        scene = file.read()

    def judged(pattern, new, told, code):
        changed = re.sub(pattern, new, scene, count=1)
        assert changed != scene, pattern
        with open("t/changed.yaml", "w", encoding="utf-8") as file:
            file.write(changed)
        out = run("doctor", "t/changed.yaml", code=code)[0]
        assert re.search(told, out), (told, out)

    number = r"\[([^]]*)\]"
    judged(r"base: *\{xyz: *" + number, "base: {xyz: [0, -3, 0]", "WRONG reach: the arm takes 0 of .*3.* m from the base", 2)
    judged(r"tool: *\{xyz: *" + number + ", *rpy: *" + number, "tool: {xyz: [0, 0, 0.03], rpy: [3.14159, 0, 0]",
           "WRONG robot.tool: .* back at the arm", 2)
    judged(r"tool: *\{", "gripper: {xyz: [0, 0.08, 0.16], rpy: [0, 0, 0]}\n  tool: {",
           r"ok +robot.gripper: the gripping point is at \(0.00, 0.08, 0.16\) in tool0", 0)
    judged(r"model: l515", "model: d405", "NOTE .*sensor.range: 0.25 to 9 m is not what the d405 measures", 0)
    judged(r"(?s)objects:.*", "objects: []\n", "NOTE  robot.gripper: not given", 0)
    judged(r"scan_volume: *\{min: *" + number + ", *max: *" + number,
           "scan_volume: {min: [-0.2, 0.4, 0.4], max: [0.2, 0.75, 0.45]}\n#", "NOTE  fruit outside of scan_volume.*1", 0)
    judged(r"scan_volume: *\{min: *" + number + ", *max: *" + number,
           "scan_volume: {min: [-0.2, 0.55, 0], max: [0.2, 0.75, 0.45]}\n#", "NOTE  fruit that reach out of scan_volume.*3", 0)


@case
def suggestions():
    """The nearest option, value, file and key."""
    small_truss()
    for words, code, told in [
            (["scan", "t", "-o", "r", "--max-veiws", "3"], 1, "did you mean '--max-views'"),
            (["scan", "t", "-o", "r", "--preset", "defualt"], 1, "'defualt'; did you mean 'default'"),
            (["scan", "t", "-o", "r", "--noise", "lm515"], 1, "did you mean 'l515'"),
            (["process", "t/sene.yaml", "-o", "r"], 2, "t/sene.yaml: no such file; did you mean 't/scene.yaml'"),
            (["process", "u/cloud.ply", "-o", "r"], 2, "u/cloud.ply: no such file"),
            (["process", "t/fruit_7.stl", "-o", "r"], 2, "no such file$")]:
        error = run(*words, code=code)[1]
        assert re.search(told, error, re.M), (told, error)
    with open("p.yaml", "w", encoding="utf-8") as file:
        file.write("gain:\n  min_gian: 1\n")
    assert "p.yaml:2: unknown key 'gain.min_gian'; did you mean 'min_gain'" in run(
        "scan", "t", "-o", "r", "--params", "p.yaml", code=2)[1]
    assert not os.path.exists("r")


@case
def progress():
    """The progress is drawn over on a terminal, cut to its width, and plain lines everywhere else."""
    small_truss()
    scan = ["scan", "t", "-o", "r", "--force", "--max-views", "2", "--no-picture", "--no-report"]
    out, error = run(*scan)
    assert "\r" not in out + error and "\033" not in out + error
    assert re.findall(r"^\d+/\d+ views", error, re.M) == ["1/2 views", "2/2 views"], error
    drawn = [line for line in re.split(r"[\r\n]+", on_terminal([AGRISEE, *scan], 60)) if line.startswith("[")]
    assert len(drawn) == 2 and all(len(line.replace("\033[K", "")) < 60 for line in drawn), drawn
    assert "\033" not in on_terminal([AGRISEE, *scan], 60, {"TERM": "dumb"})
    assert json_alone(on_terminal(["sh", "-c", " ".join([AGRISEE, *scan, "--json", ">out.json"])], 60))


def json_alone(drawn):
    import json
    with open("out.json", encoding="utf-8") as file:
        return json.load(file)["views"] == 2 and "{" not in drawn


shutil.rmtree(WORK, ignore_errors=True)
os.makedirs(WORK)
os.chdir(WORK)
CASES[CASE]()
