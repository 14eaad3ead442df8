#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The command from outside: files, exit codes, messages, determinism. Usage: run.sh AGRISEE WORKDIR CASE
set -uo pipefail
agrisee=$1 work=$2/$3
rm -rf "$work" && mkdir -p "$work" && cd "$work" || exit 1

fail() { echo "FAILED: $*" >&2; exit 1; }
# expect CODE PATTERN ARGS...: the command ends with CODE and its stderr matches PATTERN
expect() {
  local code=$1 pattern=$2; shift 2
  "$agrisee" "$@" >out.txt 2>err.txt; local got=$?
  [ $got = "$code" ] || { cat err.txt >&2; fail "agrisee $*: exit $got, expected $code"; }
  [ -z "$pattern" ] || grep -qE -- "$pattern" err.txt || { cat err.txt >&2; fail "agrisee $*: stderr does not match '$pattern'"; }
}
small_sensor() { sed -i 's/width: *1024/width: 512/; s/height: *768/height: 384/' "$1"; }

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
    [ ! -e d ] || fail "a refused scan wrote something"
    expect 2 'no_such_folder' evaluate t/scene.yaml no_such_folder
    expect 1 'total|hidden' make-truss --total 2 --hidden 5 -o x
    ;;
  few_points)
    for points in '' '0 0 0' '0 0 0
1 1 1' "$(for _ in $(seq 200); do echo 1 1 1; done)" "$(for i in $(seq 200); do echo 0.00$i 0 0; done)" "$(for i in $(seq 50); do echo nan 0 0; done)"; do
      n=$(printf '%s' "$points" | grep -c .)
      printf 'ply\nformat ascii 1.0\nelement vertex %s\nproperty float x\nproperty float y\nproperty float z\nend_header\n%s\n' "$n" "$points" >p.ply
      expect 0 '' process p.ply -o d --force
      grep -q '^0 fruit' out.txt || fail "found fruit in $n degenerate points"
    done
    ;;
  scan)
    "$agrisee" make-truss --total 4 --hidden 1 --seed 3 -o t >/dev/null || fail make-truss
    small_sensor t/scene.yaml
    for threads in 1 2; do
      expect 0 'view 1' scan t/scene.yaml -o "r$threads" --noise l515 --seed 5 --threads $threads --max-views 6
      for f in cloud.ply cloud_raw.ply views.csv fruits.json fruits.csv run.json truss.png; do
        [ -s "r$threads/$f" ] || fail "$f is missing"
      done
    done
    for f in cloud.ply cloud_raw.ply fruits.json fruits.csv truss.png; do
      cmp "r1/$f" "r2/$f" || fail "$f depends on the number of threads"
    done
    cut -d, -f1-22 r1/views.csv | cmp - <(cut -d, -f1-22 r2/views.csv) || fail "views depend on the number of threads"
    strip() { python3 -c 'import json,sys; d=json.load(open(sys.argv[1])); d.pop("seconds"); d.pop("threads"); print(d)' "$1"; }
    [ "$(strip r1/run.json)" = "$(strip r2/run.json)" ] || fail "run.json depends on the number of threads"
    expect 1 'force' scan t/scene.yaml -o r1
    expect 0 '' evaluate t/scene.yaml r1 --json
    python3 - out.txt <<'PY' || fail "fruit missed or invented"
import json, sys
m = json.load(open(sys.argv[1]))
assert m["n_real"] == 4 and m["ce"] == 0 and m["p_obj"] == 1 and m["r_obj"] == 1, m
PY
    expect 0 '' process r1/cloud.ply -o again --viewpoint 0,0,0.2
    expect 1 'input' process r1/cloud.ply -o r1 --force
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
  *) fail "unknown case $3" ;;
esac
