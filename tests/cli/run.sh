#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The command from outside: files, exit codes, messages, determinism. Usage: run.sh AGRISEE WORKDIR CASE
set -uo pipefail
. "$(dirname "$0")/support.sh"

case $3 in
  usage)
    expect 1 '' && expect 1 '' no-such-command && expect 1 '' scan && expect 1 'preset' scan s.yaml -o d --preset other
    expect 0 '' --help && grep -q 'Examples' out.txt && expect 0 '' scan --help && expect 0 '' --version
    ;;
  bad_input)
    expect 2 'missing.yaml' scan missing.yaml -o d
    [ ! -e d ] || fail "a scan of a missing file wrote something"
    expect 2 'missing.ply' process missing.ply -o d
    : >empty.ply && expect 2 'empty.ply' process empty.ply -o d
    printf 'ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 x\n' >bad.ply
    expect 2 'bad.ply' process bad.ply -o d
    printf 'ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n' >huge.ply
    expect 2 'huge.ply' process huge.ply -o d
    "$agrisee" make-truss --total 3 --hidden 0 --seed 1 -o t >/dev/null || fail make-truss
    sed 's/scan_volume/scan_volum/' t/scene.yaml >t/typo.yaml && expect 2 'typo.yaml.*scan_volum' scan t/typo.yaml -o d
    expect 1 'noise|gaussian' scan t/scene.yaml -o d --noise gaussian:-1
    printf 'sor:\n  mean_kk: 3\n' >p.yaml && expect 2 'p.yaml:2.*sor.mean_kk' scan t/scene.yaml -o d --params p.yaml
    printf 'sor:\n  mean_k: many\n' >p.yaml && expect 2 'p.yaml:2.*sor.mean_k' scan t/scene.yaml -o d --params p.yaml
    printf 'normals:\n  radius: -1\n' >p.yaml && expect 2 'p.yaml.*radius' scan t/scene.yaml -o d --params p.yaml
    mkdir folder && expect 2 'folder.*directory' scan t/scene.yaml -o d --params folder
    printf 'normals:\n  radius: .inf\n' >p.yaml && expect 2 'p.yaml:2.*normals.radius.*finite' scan t/scene.yaml -o d --params p.yaml
    printf 'max_views: 3\n---\nmax_views: 4\n' >p.yaml && expect 2 'p.yaml.*more than one' scan t/scene.yaml -o d --params p.yaml
    expect 1 'radius.*20 mm are 0.02' scan t/scene.yaml -o d --radius 20,50
    printf 'split:\n  bodies:\n    radius_min: 25\n' >p.yaml && expect 2 'p.yaml:3.*radius_min.*25 mm are 0.025' scan t/scene.yaml -o d --params p.yaml
    sed 's/start: .*/start: [0, -90, 90, -90, -90, 0]/' t/scene.yaml >t/degrees.yaml && expect 2 'robot.start: joint 2.*degrees' scan t/degrees.yaml -o d
    sed 's/\(base: .*rpy: \).*/\1[0, 0, 180]}/' t/scene.yaml >t/turned.yaml && expect 2 'robot.base.rpy.*degrees' scan t/turned.yaml -o d
    expect 1 'radius' scan t/scene.yaml -o d --radius 0.03,0.02 && expect 1 'radius' scan t/scene.yaml -o d --radius 0.001,0.5
    [ ! -e d ] || fail "a refused scan wrote something"
    expect 2 'no_such_folder' evaluate t/scene.yaml no_such_folder
    expect 1 'total|hidden' make-truss --total 2 --hidden 5 -o x
    expect 1 '--kind.*banana' make-plant --kind banana -o x && expect 1 '--foliage.*0.9' make-plant --foliage 0.9 -o x
    expect 1 'total must be .*12 for each truss' make-plant --kind cherry --total 13 -o x && expect 1 'radius_tip' make-plant --radius 0.03,0.001 -o x
    [ ! -e x ] || fail "a refused plant wrote something"
    ;;
  plant)
    for folder in p1 p2; do
      expect 0 '' make-plant --kind cherry --total 4 --foliage 0.1 --posts 1 --seed 3 -o $folder
      grep -q '^cherry_4_s3: 4 fruit; leaves hide [0-9.]* %' out.txt || fail "the summary: $(cat out.txt)"
    done
    diff -r p1 p2 || fail "the same seed gave another plant"
    expect 1 'already holds a scene' make-plant -o p1
    expect 0 '' make-plant --kind cherry --total 4 --foliage 0 --leaves-behind 0 --seed 4 -o p2 --force --json
    grep -q '"foliage": 0.0' out.txt && ! cmp -s p1/fruit_1.stl p2/fruit_1.stl || fail "another seed gave the same plant"
    grep -c 'class: fruit' p2/scene.yaml | grep -qx 4 || fail "not four fruit: $(cat p2/scene.yaml)"
    python3 -c 'import json; f = json.load(open("p2/ground_truth.json"))["fruits"]; assert [x["id"] for x in f] == [1, 2, 3, 4]' ||
      fail "the ground truth does not name the four fruit"
    ;;
  few_points)
    for points in '' '0 0 0' '0 0 0
1 1 1' "$(for _ in $(seq 200); do echo 1 1 1; done)" "$(for i in $(seq 200); do echo 0.00$i 0 0; done)" "$(for i in $(seq 50); do echo nan 0 0; done)"; do
      n=$(printf '%s' "$points" | grep -c .)
      printf 'ply\nformat ascii 1.0\nelement vertex %s\nproperty float x\nproperty float y\nproperty float z\nend_header\n%s\n' "$n" "$points" >p.ply
      expect 0 '' process p.ply -o d --force
      grep -q '^0 fruit' out.txt || fail "found fruit in $n degenerate points"
      grep -q '^No fruit: .' out.txt || fail "it is not said why $n points hold no fruit"
      grep -q '"no_fruit": "' d/run.json || fail "run.json does not say why $n points hold no fruit"
    done
    # A cloud in millimetres.
    python3 - <<'PY'
points = [(x, 500 + (x * x + z * z) / 100, z) for x in range(-40, 41, 3) for z in range(-40, 41, 3)]
with open("mm.ply", "w") as f:
    f.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(points) + "".join("property float %s\n" % a for a in "xyz") + "end_header\n")
    f.writelines("%g %g %g\n" % p for p in points)
PY
    expect 2 'mm.ply: the cloud is 1[0-9][0-9] m across.*millimetres' process mm.ply -o mm
    [ ! -e mm ] || fail "a cloud in millimetres wrote something"
    ;;
  many)
    for n in 2 3; do
      "$agrisee" make-truss --total $n --hidden 0 --seed $n -o "season/t$n" >/dev/null || fail make-truss
      small_sensor "season/t$n/scene.yaml"
    done
    mkdir season/t9 && echo 'name: [' >season/t9/scene.yaml
    # One that fails does not stop the rest.
    expect 2 'failed: season/t0/scene.yaml: .*no such file' scan season/t2/scene.yaml season/t0/scene.yaml season/t3/scene.yaml -o one --max-views 2
    grep -q '^3 inputs, 1 failed' out.txt || fail "the end of a list does not say what failed"
    [ "$(cut -d, -f2,3,5 one/summary.csv | tr '\n' ' ')" = 'folder,status,views t2,ok,2 t0,failed, t3,ok,2 ' ] || fail "summary: $(cat one/summary.csv)"
    [ -f one/t2/fruits.json ] && [ -f one/t3/report.html ] && [ ! -e one/t0 ] || fail "a folder a scene"
    # Shards share the list; merged they tell what one call tells.
    expect 2 'failed: season/t9' scan 'season/*/scene.yaml' -o two --max-views 2 --shard 1/2
    expect 2 'summary-2-of-2.csv: is missing' merge two
    expect 0 '' scan 'season/*/scene.yaml' -o two --max-views 2 --shard 2/2
    expect 0 '' merge two
    [ "$(cut -d, -f1-6 two/summary.csv)" = "$(printf '%s\n' input,folder,status,fruits,views,stop_reason \
      "season/t2/scene.yaml,t2,ok,$(sed -n 2p one/summary.csv | cut -d, -f4),2,max_views" \
      "season/t3/scene.yaml,t3,ok,$(sed -n 4p one/summary.csv | cut -d, -f4),2,max_views" \
      season/t9/scene.yaml,t9,failed,,,)" ] || fail "merged: $(cat two/summary.csv)"
    cmp one/t3/fruits.json two/t3/fruits.json || fail "a scan in a list is another"
    # Clouds that are called alike are told apart by their folders.
    expect 0 '' process 'one/*/cloud.ply' -o three
    [ -f three/t2_cloud/fruits.json ] && [ -f three/t3_cloud/fruits.json ] || fail "names of clouds: $(ls three)"
    expect 2 'matches no file' process 'no/*.ply' -o four
    expect 1 'I/N' process one/t2/cloud.ply -o four --shard 3/2
    expect 1 'I <= N <= 1000000' process one/t2/cloud.ply -o four --shard 1/-2
    # Folders that cannot be entered are named. Root enters all.
    as_other=""; [ "$(id -u)" != 0 ] || as_other="setpriv --reuid=65534 --regid=65534 --clear-groups"
    mkdir -p six/in/a six/in/b six/out && cp one/t2/cloud.ply six/in/a/c.ply && cp one/t2/cloud.ply six/in/b/c.ply
    chmod -R a+rX six && chmod a+rwx six/out && chmod 0 six/in/b
    if $as_other "$agrisee" --version >/dev/null 2>&1 && $as_other test ! -x six/in/b -a -r six/in/a/c.ply; then
      for pattern in c.ply '*.ply'; do
        $as_other "$agrisee" process "six/in/*/$pattern" -o six/out --no-picture --no-report --quiet 2>err.txt || fail "a closed folder: $(cat err.txt)"
        grep -q '^agrisee: six/in/b: Permission denied; what is in it is left out' err.txt || fail "a closed folder is not named: $(cat err.txt)"
      done
      $as_other "$agrisee" process six/in/b/c.ply -o six/out/b 2>err.txt && fail "a closed folder"
      grep -q '^agrisee: six/in/b/c.ply: cannot be opened: Permission denied' err.txt || fail "a closed folder: $(cat err.txt)"
      $as_other "$agrisee" export-views six/in/b -o six/out/b 2>err.txt && fail "a closed folder"
      grep -q '^agrisee: six/in/b/scan.json: Permission denied' err.txt || fail "a raw error: $(cat err.txt)"
      $as_other "$agrisee" merge six --db six/out/s.sqlite 2>err.txt && fail "a closed folder"
      grep -qE '^agrisee: (six/in/b: Permission denied|.*without SQLite)' err.txt || fail "merge does not name the folder: $(cat err.txt)"
    fi
    chmod 755 six/in/b
    # As spread by others.
    if command -v parallel >/dev/null 2>&1; then
      parallel -j 2 "$agrisee" scan "'season/*/scene.yaml'" -o five --max-views 2 --shard {}/3 ::: 1 2 3 >/dev/null 2>&1
      expect 0 '' merge five
      [ "$(cut -d, -f1-6 five/summary.csv)" = "$(cut -d, -f1-6 two/summary.csv)" ] || fail "parallel: $(cat five/summary.csv)"
    fi
    ;;
  scan)
    "$agrisee" make-truss --total 4 --hidden 1 --seed 3 -o t >/dev/null || fail make-truss
    small_sensor t/scene.yaml
    for threads in 1 2; do
      expect 0 '^1/6 views' scan t/scene.yaml -o "r$threads" --noise l515 --seed 5 --threads $threads --max-views 6
      for f in cloud.ply cloud_raw.ply views.csv fruits.json fruits.csv run.json truss.png report.html; do
        [ -s "r$threads/$f" ] || fail "$f is missing"
      done
    done
    for f in cloud.ply cloud_raw.ply fruits.json fruits.csv truss.png; do
      cmp "r1/$f" "r2/$f" || fail "$f depends on the number of threads"
    done
    cut -d, -f1-22 r1/views.csv | cmp - <(cut -d, -f1-22 r2/views.csv) || fail "views depend on the number of threads"
    strip() { python3 -c 'import json,sys; d=json.load(open(sys.argv[1])); d.pop("seconds"); d.pop("threads"); d.pop("time"); print(d)' "$1"; }
    [ "$(strip r1/run.json)" = "$(strip r2/run.json)" ] || fail "run.json depends on the number of threads"
    grep -qE '"time": "20[0-9]{2}-[01][0-9]-[0-3][0-9]T[0-2][0-9]:[0-5][0-9]:[0-5][0-9]Z"' r1/run.json || fail "no time in run.json"
    expect 1 'force' scan t/scene.yaml -o r1
    expect 0 '' evaluate t/scene.yaml r1 --json
    python3 - out.txt <<'PY' || fail "fruit missed or invented"
import json, sys
m = json.load(open(sys.argv[1]))
assert m["n_real"] == 4 and m["ce"] == 0 and m["p_obj"] == 1 and m["r_obj"] == 1, m
PY
    SOURCE_DATE_EPOCH=1774098475 expect 0 '' process r1/cloud.ply -o again
    grep -q '"time": "2026-03-21T13:07:55Z"' again/run.json || fail "SOURCE_DATE_EPOCH does not set the time"
    # One viewpoint for what several views saw would turn normals that are right.
    expect 2 'normals face away from --viewpoint.*--turn-normals' process r1/cloud.ply -o turned --viewpoint 0,0,0.2
    expect 2 'cloud_raw.ply: its points come from several views.*--views' process r1/cloud_raw.ply -o turned --viewpoint 0,0,0.2
    [ ! -e turned ] || fail "a refused viewpoint wrote something"
    expect 0 '' process r1/cloud.ply -o turned --viewpoint 0,0,0.2 --turn-normals
    expect 1 'input' process r1/cloud.ply -o r1 --force
    expect 0 '' process r1/cloud_raw.ply -o raw --views r1/views.csv --radius 0.02,0.05 && grep -qE '^[45] fruit' out.txt || fail "process of the raw points misses fruit"
    for words in "r1/cloud_raw.ply --views raw/views.csv" "r1/cloud.ply --params raw/run.json"; do
      expect 1 'raw/.*: is an input and would be overwritten' process $words -o raw --force
    done
    expect 1 'excludes' process r1/cloud_raw.ply -o raw2 --views r1/views.csv --viewpoint 0,0,0
    ;;
  report)
    "$agrisee" make-truss --total 3 --hidden 0 --seed 1 -o t >/dev/null || fail make-truss
    small_sensor t/scene.yaml
    for threads in 1 2; do
      expect 0 '' scan t/scene.yaml -o "r$threads" --noise l515 --seed 5 --threads $threads --max-views 2
    done
    expect 0 '' process r1/cloud.ply -o p
    expect 1 'report.html' process r1/cloud.ply -o "$(rm -rf only && mkdir only && cp p/report.html only && echo only)"
    python3 - <<'PY' || fail "the report is not what the result is"
import json, os, re
def data(folder):
    page = open(folder + "/report.html", encoding="ascii").read()
    assert page.count("</html>") == 1 and os.path.getsize(folder + "/report.html") < 3e6
    return json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script>', page, re.S).group(1))
a, b, p = data("r1"), data("r2"), data("p")
assert a["fruits"] == json.load(open("r1/fruits.json")) and a["run"] == json.load(open("r1/run.json"))
assert len(a["views"]) == 2 and all(len(v["arm"]) == len(a["arm_radii"]) for v in a["views"])
names = [c["name"] for c in a["curves"]]
assert len(names) == 3 and "seen in truth" in names, names
truth = a["curves"][2]["values"]
# Nothing is planned after the last view that the budget allows, so the planner's belief is compared after the first.
assert 0.1 < truth[0] < truth[1] < 1 and abs(a["curves"][0]["values"][0] - truth[0]) < 0.1, a["curves"]
assert p["views"] == [] and p["curves"] == [] and p["cloud"]["count"] > 0.9 * a["cloud"]["count"]
for d in a, b:  # what may differ: times, and the number of threads
    d["run"].pop("seconds"), d["run"].pop("threads"), d["run"].pop("time")
    for v in d["views"]:
        v.pop("plan_seconds")
assert a == b, "depends on the number of threads"
# Every view has its depth image, an 8-bit PNG file as wide as its image, up to 256 pixels.
import base64
assert len(a["depth"]) == 2
for d in a["depth"]:
    png = base64.b64decode(d["png"])
    assert png[:4] == b"\x89PNG" and 100 < int.from_bytes(png[16:20], "big") <= 256 and 0.1 < d["near"] < d["far"] < 5, d
assert a["fruits_csv"] == open("r1/fruits.csv", newline="").read()
PY
    # While a scan runs, its page says so; interrupted and resumed, the result is that of a scan without --live.
    python3 - "$agrisee" <<'PY' || fail "scan --live"
import json, os, re, subprocess, sys, time
args = ["t/scene.yaml", "--noise", "l515", "--seed", "5", "--max-views", "6"]
def page(folder):
    data = json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script>', open(folder + "/report.html").read(), re.S).group(1))
    data["run"].pop("seconds"), data["run"].pop("time", None)
    for v in data["views"]:
        v.pop("plan_seconds")
    return data
subprocess.run([sys.argv[1], "scan", *args, "-o", "plain"], check=True, capture_output=True)
scan = subprocess.Popen([sys.argv[1], "scan", *args, "-o", "live", "--live"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
while not os.path.exists("live/report.html") and scan.poll() is None:
    time.sleep(0.002)
scan.kill()
scan.wait()
assert not os.path.exists("live/run.json"), "the scan was too fast for this test"
first, plain = page("live"), page("plain")
assert first["running"] and 1 <= len(first["views"]) < 6 and first["fruits"], first["run"]
assert len(first["depth"]) == len(first["views"]) and first["depth"][0] == plain["depth"][0]
subprocess.run([sys.argv[1], "scan", "--resume", "live", "--live"], check=True, capture_output=True)
assert page("live") == plain and "running" not in plain, "--live changes the result"
PY
    ;;
  detector)
    # Colours and masks in a scan: what it says of them, any number of threads, resumed or not, and judged.
    small_truss t --total 4 --hidden 0 --seed 2
    grep -q 'ripeness: ' t/scene.yaml || fail "the fruit of a truss have no ripeness"
    scan="t/scene.yaml --noise l515 --seed 3 --max-views 4 --no-picture"
    expect 0 '' scan $scan -o plain --threads 2
    expect 0 '' scan $scan -o a --detector typical --threads 1
    expect 0 '' scan $scan -o b --detector typical --threads 2
    for file in cloud.ply fruits.json fruits.csv; do cmp -s a/$file b/$file || fail "$file depends on the number of threads"; done
    grep -q '"detector": "typical"' a/run.json || fail "run.json does not name the detector"
    grep -q detector plain/run.json && fail "run.json names a detector that there was not"
    cmp -s plain/views/0000.view a/views/0000.view && fail "records of different scans are the same"
    rm a/run.json a/views/0003.view
    expect 0 '' scan --resume a --no-picture
    cmp -s a/fruits.json b/fruits.json || fail "a resumed scan sees other colours"
    expect 1 'detector' scan $scan -o c --detector clever
    # Exported, the views keep colors and masks.
    expect 0 '' export-views b -o views --npy && [ -s views/color/0003.png ] && [ -s views/masks/0003.png ] || fail "no colors or masks: $(ls views)"
    expect 0 '' process views -o again --no-picture && cmp b/cloud.ply again/cloud.ply || fail "the exported views give another cloud"
    python3 - b/fruits.json again/fruits.json <<'PY' || fail "the exported views give other fruit"
import json, sys
drop = lambda fruit: {k: v for k, v in fruit.items() if not k.startswith(("picking", "pre_grasp", "approach", "reachable"))}
scan, again = ([drop(f) for f in json.load(open(name))] for name in sys.argv[1:])
assert scan == again and scan and all("ripeness" in f for f in scan), (scan, again)
PY
    cp t/scene.yaml scene.yaml && echo '# changed' >>t/scene.yaml
    expect 2 't/scene.yaml: is not the scene of the scan' export-views b -o changed
    mv scene.yaml t/scene.yaml
    python3 - plain/fruits.json a/fruits.json <<'PY' || fail "ripeness in fruits.json"
import json, sys
plain, colored = (json.load(open(name)) for name in sys.argv[1:])
assert len(plain) == len(colored) == 4, (len(plain), len(colored))
assert not any("ripeness" in f for f in plain) and all("ripeness" in f for f in colored)
PY
    expect 0 '' evaluate t/scene.yaml a --json
    python3 -c 'import json; r = json.load(open("out.txt"))["ripeness"]; assert r["judged"] == 4 and r["right"] >= 0.5' || fail "evaluate does not judge ripeness"
    expect 0 '' evaluate t/scene.yaml a
    grep -q 'Ripeness of 4 fruit' out.txt || fail "evaluate does not tell of ripeness"
    expect 0 '' evaluate t/scene.yaml plain
    grep -q Ripeness out.txt && fail "evaluate judges a ripeness that was not found"
    true
    ;;
  paper)
    "$agrisee" make-truss --total 4 --hidden 1 --seed 3 -o t >/dev/null || fail make-truss
    small_sensor t/scene.yaml
    expect 0 '' scan t/scene.yaml -o r --preset paper --max-views 4 --json
    grep -q '"views": 4' out.txt || fail "the paper preset did not take its views"
    expect 0 '' evaluate t/scene.yaml r
    ;;
  out_of_reach)
    "$agrisee" make-truss --total 3 --hidden 0 --seed 1 -o t >/dev/null || fail make-truss
    python3 - <<'PY'
s = open("t/scene.yaml").read()
import re
s = re.sub(r"(base:\s*\{?\s*xyz:\s*\[)[^\]]*\]", r"\g<1>5, 5, 5]", s)
open("t/scene.yaml", "w").write(s)
PY
    expect 3 'reach' scan t/scene.yaml -o r
    grep -q no_reachable_view r/run.json || fail "the reason is not recorded"
    ;;
  nothing_there)
    "$agrisee" make-truss --total 3 --hidden 0 --seed 1 -o t >/dev/null || fail make-truss
    small_sensor t/scene.yaml
    python3 - <<'PY'
import re
s = open("t/scene.yaml").read()
s = re.sub(r"objects:.*", "objects: []\n", s, flags=re.S)
open("t/scene.yaml", "w").write(s)
PY
    "$agrisee" scan t/scene.yaml -o r >out.txt 2>err.txt; code=$?
    [ $code = 0 ] || fail "an empty scene: exit $code"
    grep -q nothing_seen r/run.json || fail "the reason is not recorded"
    ;;
  experiment)
    "$agrisee" make-truss --total 3 --hidden 0 --seed 1 -o t3 >/dev/null || fail make-truss
    "$agrisee" make-truss --total 4 --hidden 1 --seed 3 -o t4 >/dev/null || fail make-truss
    small_sensor t3/scene.yaml && small_sensor t4/scene.yaml
    run() { expect 0 "$1" experiment -o e --presets default,paper --scenes t3/scene.yaml,t4/scene.yaml --noise l515 --trials 1 --max-views 3 "${@:2}"; }
    run '4 scans, 4 of them to run' --threads 1
    [ "$(tail -n +2 e/report/scanning.csv | wc -l)" = 4 ] || fail "not a row a cell"
    cp -r e first && run '4 scans, 0 of them to run'
    grep -q 'replaced' err.txt && fail "nothing is replaced"
    cp -r e few && expect 0 '^agrisee: 2 scans have a record of other parameters \(--params, --max-views, .*replaced' experiment -o few \
      --presets default --scenes t3/scene.yaml,t4/scene.yaml --noise l515 --trials 1 --max-views 2
    for f in report.md report/scanning.csv report/segmentation.csv report/scanning.svg; do
      cmp "e/$f" "first/$f" || fail "$f did not come back as it was"
    done
    echo broken >"$(ls -d e/cells/*default*l515*1.json | head -1)" && run '4 scans, 1 of them to run'
    expect 0 '4 scans, 2 of them to run' experiment -o e --presets default --planner gain,see --scenes t3/scene.yaml,t4/scene.yaml \
      --noise l515 --trials 1 --max-views 3
    expect 1 'noise' experiment -o x --noise loud && expect 1 '' experiment -o x --presets mine
    expect 2 'missing.yaml' experiment -o x --scenes missing.yaml && expect 1 '7_9' experiment -o x --scenes 7_9
    # A cell is what scan and evaluate say of the same scene, noise and seed.
    expect 0 '' scan t3/scene.yaml -o r --noise l515 --seed 1 --max-views 3 && expect 0 '' evaluate t3/scene.yaml r --json
    python3 - out.txt first/cells/*3_0*default*.json <<'PY' || fail "experiment and evaluate disagree"
import json, sys
judged, cell = (json.load(open(f)) for f in sys.argv[1:])
for a, b in ("recall", "recall"), ("recall_obs", "recall_obs"), ("precision", "precision"), ("n_det", "n_det"), ("scanned", "scanned"):
    assert abs(judged[a] - cell["metrics"][b]) < 1e-6, (a, judged[a], cell["metrics"][b])
assert cell["views"] == 3 == len(cell["recall_after"]) and cell["metrics"]["recall_obs"] == cell["recall_after"][-1]
PY
    expect 0 '' paper-scenes -o p && [ "$(ls p | wc -l)" = 11 ] && expect 1 'force' paper-scenes -o p
    ;;
  limit)
    "$agrisee" make-truss --total 3 --hidden 0 --seed 1 -o t >/dev/null || fail make-truss
    small_sensor t/scene.yaml
    expect 2 'missing.yaml' limit missing.yaml -o d
    sed 's/scan_volume/scan_volum/' t/scene.yaml >t/typo.yaml && expect 2 'typo.yaml.*scan_volum' limit t/typo.yaml -o d
    sed 's/class: fruit/class: other/; s/id: [0-9]*/id: 0/; s/ripeness: [^,}]*,//' t/scene.yaml >t/bare.yaml && expect 2 'bare.yaml.*no fruit' limit t/bare.yaml -o d
    expect 2 'bare.yaml.*no fruit' scan t/bare.yaml -o d --planner greedy
    expect 1 'base-search' limit t/scene.yaml -o d --base-step 0.1
    expect 1 'step' limit t/scene.yaml -o d --base-search --base-range 1 --base-step 0.001
    [ ! -e d ] || fail "a refused limit wrote something"
    for threads in 1 2; do
      expect 0 '' limit t/scene.yaml -o "l$threads" --base-search --base-range 0.3 --base-step 0.3 --threads $threads
      grep -q 'Every fruit can be seen' out.txt || fail "the summary does not tell"
      grep -q '<- present' out.txt || fail "the present place is not marked"
    done
    for f in limit.json observable.ply views.csv; do
      cmp "l1/$f" "l2/$f" || fail "$f depends on the number of threads"
    done
    expect 1 'force' limit t/scene.yaml -o l1
    expect 0 '' limit t/scene.yaml -o l1 --force --json
    cmp out.txt l1/limit.json || fail "what --json prints is not limit.json"
    python3 - <<'PY' || fail "the figures contradict each other"
import csv, json, struct
m = json.load(open("l2/limit.json"))
assert 0.5 < m["observable"] < 0.9 and len(m["fruits"]) == 3, m
places = m["base_search"]["places"]
assert len(places) == 9 and sum(p["present"] for p in places) == 1
best = [p["observable"] for p in places]
assert best == sorted(best, reverse=True)
raw = open("l2/observable.ply", "rb").read()
head, body = raw.split(b"end_header\n", 1)
for name in b"nx", b"red", b"int instance", b"int seen_by":
    assert name in head, name
records = list(struct.iter_unpack("<6f3B2i", body))
assert len(records) == m["samples"] == sum(f["samples"] for f in m["fruits"])
seen = [r for r in records if r[10] > 0]
assert abs(len(seen) / len(records) - m["observable"]) < 1e-12
for f in m["fruits"]:
    own = [r[10] > 0 for r in records if r[9] == f["id"]]
    assert abs(sum(own) / len(own) - f["observable"]) < 1e-12, f
assert len({r[6:9] for r in records if r[10] == 0}) == 1
views = list(csv.DictReader(open("l2/views.csv")))
new = [int(v["points_new"]) for v in views]
assert sum(new) == len(seen) and all(n > 0 for n in new)
for row in m["views"]:  # the views of the file are those begun frontally
    n = row["begun_frontal"]
    assert sum(new[:n]) >= row["share"] * len(seen) > sum(new[: n - 1]), row
    assert 1 <= row["begun_freely"] <= n + 2, row
PY
    expect 0 '' scan t/scene.yaml -o r --planner greedy --max-views 3
    grep -q '"planner": "greedy"' r/run.json || fail "the planner is not recorded"
    cut -d, -f2-4 r/views.csv | cmp - <(head -4 l2/views.csv | cut -d, -f2-4) || fail "the greedy planner takes other views"
    expect 1 'scan' limit t/scene.yaml -o r --force
    sed -E 's/(base: *\{? *xyz: *\[)[^]]*\]/\15, 5, 5]/' t/scene.yaml >t/far.yaml
    expect 0 '' limit t/far.yaml -o far
    grep -q 'nothing is within reach' out.txt || fail "an arm that reaches nothing is not told of"
    [ "$(wc -l <far/views.csv)" = 1 ] && grep -q '"observable": 0.0' far/limit.json || fail "figures of nothing"
    ;;
  *) fail "unknown case $3" ;;
esac
