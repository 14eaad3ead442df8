#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What the command takes in, and what it leaves out or says when asked. Usage: inputs.sh AGRISEE WORKDIR CASE
set -uo pipefail
. "$(dirname "$0")/support.sh"

case $3 in
  recorded)  # the frames of a scan, recorded, give the fruit of the scan
    small_truss t --total 4 --hidden 1 --seed 3
    expect 0 '' scan t -o r --noise l515 --seed 5 --max-views 6
    expect 0 '' export-views r -o exact --npy && grep -q '^6 views' out.txt || fail "export-views: $(cat out.txt)"
    expect 0 '' export-views r -o png
    expect 1 'force' export-views r -o png && expect 0 '' export-views r -o png --force
    expect 0 '^6/6 views: [0-9]+ points in the scan volume, ' process exact/views.yaml -o a && expect 0 '' process png -o b
    expect 0 '' export-views r -o png --npy --force && [ ! -e png/depth/0000.png ] || fail "images of the call before"
    expect 0 '' export-views r -o png --force && [ ! -e png/depth/0000.npy ] && expect 0 '' process png -o b --force
    grep -qE '^4 fruit, [0-9]+ points from 6 views, ' out.txt || fail "summary: $(head -1 out.txt)"
    printf 'split:\n  growing:\n    seeds_by_curvature: true\n    max_curvature: 0.2\n' >curved.yaml
    for preset in default paper; do
      expect 0 '' process exact -o curved_$preset --preset $preset --params curved.yaml --no-picture --no-report
      grep -qE '^[1-9] fruit' out.txt || fail "growing by curvature, $preset: $(cat out.txt)"
    done
    expect 0 '' process r/cloud_raw.ply --views r/views.csv -o curved_cloud --params curved.yaml --no-picture --no-report
    cmp r/cloud.ply a/cloud.ply || fail "the exact frames give another cloud than the scan"
    cmp r/cloud_raw.ply a/cloud_raw.ply || fail "the exact frames give another merged cloud than the scan"
    python3 - <<'PY' || fail "the recorded views give other fruit than the scan"
import json
scan, exact, png = (json.load(open(f + "/fruits.json")) for f in "rab")
drop = lambda fruit: {k: v for k, v in fruit.items() if not k.startswith(("picking", "pre_grasp", "approach", "reachable"))}
assert [drop(f) for f in scan] == [drop(f) for f in exact], "exact"
assert len(scan) == len(png) == 4
for a, b in zip(scan, png):
    d = max(abs(p - q) for p, q in zip(a["center_world"], b["center_world"]))
    assert 0 < d < 0.0005, d
assert all(f["picking_reason"] == "not_tested" for f in exact if f["picking_reason"] not in ("no_body", "blocked_by_fruit"))
runs = [json.load(open(f + "/run.json")) for f in "ra"]
assert runs[1]["views"] == 6 and runs[1]["planner"] == "none" and runs[0]["cluster_origin_world"] == runs[1]["cluster_origin_world"]
PY
    # A view that is missing is told of; a damaged one leaves nothing half-written.
    cp -r r gap && rm gap/views/0003.view gap/views/0005.view
    expect 0 'gap/views: holds no record of view 3,5, which is left out' export-views gap -o gaps && grep -q '^4 views' out.txt || fail "gaps: $(cat out.txt)"
    [ "$(grep -c 'depth: ' gaps/views.yaml)" = 4 ] && grep -q 0004.png gaps/views.yaml || fail "gaps: $(cat gaps/views.yaml)"
    truncate -s 1000 gap/views/0004.view
    expect 2 '0004.view: is damaged; .*run.json.*--resume.*the others are exported' export-views gap -o damaged && [ ! -e damaged ] || fail "a half export"
    rm gap/views/0004.view gap/run.json && expect 0 '' scan --resume gap && cmp gap/fruits.json r/fruits.json || fail "the views are not taken again"
    mkdir -p mine/depth && echo mine >mine/depth/0000.png
    expect 1 'mine/depth/0000.png: exists; use --force to overwrite it' export-views r -o mine && grep -q mine mine/depth/0000.png && [ ! -e mine/views.yaml ] || fail "a foreign image"
    expect 0 '' export-views r -o mine --force && cmp mine/depth/0000.png png/depth/0000.png || fail "a foreign image with --force"
    # Without a scan volume all that is seen counts; poses may be stated in other forms.
    python3 - <<'PY'
import re
text = open("png/views.yaml").read()
open("png/open.yaml", "w").write(re.sub(r"scan_volume: .*\n", "", text))
PY
    expect 0 '' process png/open.yaml -o c
    grep -q '^4 fruit' out.txt || fail "without a scan volume: $(head -1 out.txt)"
    # Single pixels far away do not make the scan volume large; if there is nothing else, or poses are far apart, that is told.
    python3 - <<'PY'
import re, shutil, struct
text = re.sub(r"scan_volume: .*\n", "", open("exact/views.yaml").read())
whole = open("exact/depth/0002.npy", "rb").read()
image = whole[:-8] + struct.pack("<2f", 65.5, 40)
open("exact/depth/stray.npy", "wb").write(image)
text = text.replace("0002.npy", "stray.npy")
open("exact/stray.yaml", "w").write(text)
head = len(whole) - 4 * 512 * 384
open("exact/depth/far.npy", "wb").write(whole[:head] + struct.pack("<f", 30) * (512 * 384))
open("exact/far.yaml", "w").write(re.sub(r"\d\d\d\d.npy|stray.npy", "far.npy", text))
pose = iter([80, -80])
open("exact/apart.yaml", "w").write(re.sub(r"(pose: \[\[[^,]*,[^,]*,[^,]*, )[^\]]*", lambda m: m.group(1) + str(next(pose, 0)), text))
PY
    expect 0 '' process png/open.yaml -o no_stray --no-picture --no-report && ! grep -q 'pixel' out.txt || fail "no stray: $(cat out.txt)"
    expect 0 '' process exact/stray.yaml -o stray --no-picture --no-report
    grep -q '^4 fruit' out.txt && grep -q '^Note: 2 pixels lie more than 10 m from the camera .*scan_volume' out.txt || fail "stray pixels: $(cat out.txt)"
    expect 2 'far.yaml: no depth image has a single return within 10 m of the camera: are the depths in metres' process exact/far.yaml -o d
    expect 2 'apart.yaml: what its views show is 16[0-9] m long: are the positions of the poses in metres' process exact/apart.yaml -o d
    # Of an MCAP file the range can be shortened.
    expect 0 '' scan t -o filmed --noise l515 --seed 5 --max-views 2 --mcap filmed.mcap --no-picture --no-report
    for range in 0.1,9:wide 0.05,0.1:short; do
      expect 0 '' process filmed.mcap -o ${range#*:} --range ${range%:*} --no-picture --no-report
    done
    expect 0 '' process filmed.mcap -o all --no-picture --no-report && cmp all/fruits.json wide/fruits.json || fail "a wide range"
    [ "$(grep -c '"id"' all/fruits.json)" -gt 0 ] && [ "$(grep -c '"id"' short/fruits.json)" = 0 ] || fail "a short range"
    # A wrong scale, size, pose or file is told of, with the place, and nothing is written.
    sed 's/depth_scale: .*/depth_scale: 1/' png/views.yaml >png/scale.yaml
    expect 2 'scale.yaml:[0-9]+: views\[0\].depth: .*median depth.*depth_scale' process png/scale.yaml -o d
    sed 's/width: .*/width: 640/' png/views.yaml >png/size.yaml
    expect 2 'size.yaml:[0-9]+: views\[0\].depth: .*512 x 384 pixels, but the camera 640 x 384' process png/size.yaml -o d
    sed 's/0003.png/0009.png/' png/views.yaml >png/file.yaml
    expect 2 'file.yaml:[0-9]+: views\[3\].depth: no such file' process png/file.yaml -o d
    sed 's/^  - depth: .*/&\n    camera: {width: 512}/' png/views.yaml >png/two.yaml
    expect 2 'two.yaml:[0-9]+: views\[0\].camera: all views of a file share its one camera: write a file for each' process png/two.yaml -o d
    sed 's/    pose: \[\[[^,]*/    pose: [[5/' png/views.yaml >png/pose.yaml
    expect 2 'pose.yaml:[0-9]+: views\[0\].pose: is not a rigid transform' process png/pose.yaml -o d
    sed 's/camera:/kamera:/' png/views.yaml >png/key.yaml
    expect 2 "key.yaml:[0-9]+: unknown key 'kamera'; did you mean 'camera'" process png/key.yaml -o d
    sed 's/^camera:/&\n  distortion: [10, 0, 0, 0, 0]/' png/views.yaml >png/lens.yaml
    expect 2 'lens.yaml:[0-9]+: camera.distortion: .*are these the coefficients of this camera' process png/lens.yaml -o d
    # Poses that are stated in another way are refused; so are those in millimetres.
    python3 - <<'PY'
import json, re
text = open("exact/views.yaml").read()
times = lambda a, b: [[sum(a[r][k] * b[k][c] for k in range(4)) for c in range(4)] for r in range(4)]
def inverted(m):
    turned = [[m[c][r] for c in range(3)] for r in range(3)]
    return [turned[r] + [-sum(turned[r][k] * m[k][3] for k in range(3))] for r in range(3)] + [[0, 0, 0, 1]]
def restated(name, change):
    pose = lambda m: "pose: " + json.dumps(change(json.loads(m.group(1))))
    open(f"exact/{name}.yaml", "w").write(re.sub(r"pose: (\[\[.*\]\])", pose, text))
restated("inverted", inverted)
restated("body", lambda m: times(m, [[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]]))
poses = re.findall(r"pose: \[\[.*\]\]", text)
shifted = iter(poses[1:] + poses[:1])
open("exact/shifted.yaml", "w").write(re.sub(r"pose: \[\[.*\]\]", lambda m: next(shifted), text))
restated("same", lambda m, first=json.loads(re.search(r"pose: (\[\[.*\]\])", text).group(1)): first)
def w_first(m):  # as x y z w, from a file that states w x y z
    q = [1 + m[0][0] + m[1][1] + m[2][2], m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]]
    n = sum(c * c for c in q) ** 0.5
    return f"{{xyz: {[row[3] for row in m[:3]]}, quaternion: {[c / n for c in q]}}}"
pose = lambda m: "pose: " + w_first(json.loads(m.group(1)))
open("exact/w_first.yaml", "w").write(re.sub(r"pose: (\[\[.*\]\])", pose, text))
lines = text.splitlines(True)
away = [i for i, line in enumerate(lines) if "pose: " in line][:3]
for i in away:  # three of six views look elsewhere
    m = json.loads(lines[i].split("pose: ")[1])
    lines[i] = "    pose: " + json.dumps(m[:1] + [m[1][:3] + [m[1][3] - 2.0]] + m[2:]) + "\n"
open("exact/away.yaml", "w").write("".join(lines))
restated("mm", lambda m: [row[:3] + [1000 * row[3]] for row in m[:3]] + m[3:])
PY
    expect 2 'shifted.yaml: [0-9]+ of [0-9]+ views contradict the others' process exact/shifted.yaml -o d
    expect 2 'inverted.yaml: it seems that the poses are inverted \(optical_T_world\)\..*world_T_optical' process exact/inverted.yaml -o d
    expect 2 'body.yaml: it seems that the poses are those of a frame with x forward' process exact/body.yaml -o d
    expect 2 'same.yaml: all 6 views have the same pose, but different images' process exact/same.yaml -o d
    expect 2 'w_first.yaml: it seems that the poses have quaternions in the order w x y z' process exact/w_first.yaml -o d
    [ ! -e d ] || fail "refused poses wrote something"
    expect 0 '' process exact/away.yaml -o away --no-picture --no-report
    grep -qE '^Note: 3 of 6 views show nothing of the scan volume \(0,1,2\): are their poses right\? .*quaternions are x y z w' out.txt || fail "views that look elsewhere: $(cat out.txt)"
    sed '/0001.npy/,$d' exact/views.yaml >exact/still.yaml && sed -n '/^  - depth/,$p' exact/still.yaml >view.txt && cat view.txt >>exact/still.yaml
    expect 0 '' process exact/still.yaml -o still --no-picture --no-report
    expect 2 'mm.yaml: observe: the sensor of view 0 stood [0-9]+ m from the scan volume: is its position in millimetres' process exact/mm.yaml -o mm
    [ ! -e mm ] || fail "poses in millimetres wrote something"
    sed 's/depth_scale: .*/depth_scale: 0.001/' png/views.yaml >png/tenfold.yaml && expect 0 '' process png/tenfold.yaml -o tenfold --no-picture --no-report
    grep -qE '^No fruit: .*the median depth is [3-9](\.[0-9]+)? m, .*\(depth_scale\)' out.txt || fail "a wrong depth_scale: $(cat out.txt)"
    cp png/depth/0001.png png/depth/0002.png && truncate -s 1000 png/depth/0002.png
    expect 2 'views.yaml:[0-9]+: views\[2\].depth: .*0002.png: is cut off' process png -o d
    [ ! -e d ] || fail "a refused recording wrote something"
    mkdir bare && expect 2 'bare: is a folder without views.yaml' process bare -o d && expect 2 'bare: is a folder without scene.yaml' scan bare -o d
    expect 2 '--viewpoint' process exact -o d --viewpoint 0,0,0
    ;;
  clouds)  # one cloud in every format gives the same fruit
    small_truss t --total 3 --hidden 0 --seed 1
    expect 0 '' scan t/scene.yaml -o r --noise l515 --seed 1 --max-views 2
    python3 - <<'PY'
import struct
head, body = open("r/cloud_raw.ply", "rb").read().split(b"end_header\n", 1)
rows = list(struct.iter_unpack("<3fi", body))
text = [" ".join(f"{c:.9g}" for c in row[:3]) for row in rows]
open("c.xyz", "w").write("\n".join(text) + "\n")
open("c.csv", "w").write("x,y,z,view\n" + "".join(f"{t.replace(' ', ',')},{r[3]}\n" for t, r in zip(text, rows)))
header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({len(rows)}, 3), }}\n".encode()
open("c.npy", "wb").write(b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header + b"".join(struct.pack("<3f", *r[:3]) for r in rows))
# --views needs no more than numbers and positions.
lines = [line.split(",")[:4] for line in open("r/views.csv").read().splitlines()]
open("positions.csv", "w").write("\n".join(",".join(line) for line in lines) + "\n")
PY
    expect 0 '' process r/cloud_raw.ply -o ply && cp out.txt ply.txt
    grep -qE '^3 fruit, [0-9]+ points, ' out.txt || fail "summary: $(head -1 out.txt)"
    for f in xyz npy; do
      expect 0 '' process c.$f -o $f
      cmp ply/fruits.json $f/fruits.json || fail "the same cloud as $f gives other fruit"
    done
    "$agrisee" process - -o pipe <c.npy >/dev/null || fail "standard input, redirected"
    python3 - <<'PY'
import struct
def npy(name, descr, shape, data):
    header = f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    open(name, "wb").write(b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header + data)
npy("fields.npy", "[('x', '<f4'), ('y', '<f4'), ('z', '<f4')]", "(1,)", bytes(12))
npy("half.npy", "'<f2'", "(1, 3)", bytes(6))
rows = [[float(c) for c in line.split()] for line in open("c.xyz")]
npy("four.npy", "'<f4'", f"({len(rows)}, 4)", b"".join(struct.pack("<4f", *row, 7.0) for row in rows))
PY
    expect 2 'fields.npy: holds records with named fields; save an array of numbers' process fields.npy -o d
    expect 2 "half.npy: holds numbers of the type '<f2', which is not read" process half.npy -o d
    expect 0 'four.npy: of its 4 columns only the first three' process four.npy -o four --no-picture --no-report && cmp ply/fruits.json four/fruits.json || fail "four columns"
    cat c.xyz | "$agrisee" process - -o pipe2 >/dev/null || fail "standard input, piped"
    "$agrisee" process <(cat r/cloud_raw.ply) -o pipe3 >/dev/null || fail "a named pipe"
    for f in pipe pipe2 pipe3; do cmp ply/fruits.json $f/fruits.json || fail "$f gives other fruit"; done
    grep -q '"scene": "standard input"' pipe/run.json || fail "the input is not named"
    echo '%PDF' | "$agrisee" process - -o d 2>err.txt && fail "a PDF is no cloud"
    grep -q 'agrisee: standard input: is no point cloud' err.txt || fail "standard input is not named: $(cat err.txt)"
    # One viewpoint for a cloud of several views that does not say so, and one behind the cloud of a single view.
    for f in xyz npy; do
      expect 2 "c.$f: [0-9]+ % of the points lie hidden behind others.*--views.*--turn-normals" process c.$f -o d --viewpoint 0,0,0.2
    done
    python3 - <<'PY'
rows = [line.rsplit(",", 1) for line in open("c.csv").read().splitlines()]
open("first.csv", "w").write("\n".join(point for point, view in rows if view in ("view", "0")) + "\n")
PY
    expect 2 'first.csv: [0-9]+ % of what is curved as fruit is hollow as seen from the viewpoint' process first.csv -o d --viewpoint 0,1.2,0.2
    expect 2 'first.csv: the position of a sensor \(the viewpoint\) is not finite' process first.csv -o d --viewpoint nan,0,0
    [ ! -e d ] || fail "a refused viewpoint wrote something"
    expect 0 '' process first.csv -o first --viewpoint 0,0,0.2 && ! grep -q '^Note' out.txt || fail "the right viewpoint: $(cat out.txt)"
    expect 0 '' process first.csv -o behind --viewpoint 0,1.2,0.2 --turn-normals && grep -q '^Note: .* is hollow as seen from the viewpoint' out.txt || fail "no note"
    expect 0 '' process c.csv -o csv --views positions.csv && expect 0 '' process r/cloud_raw.ply -o full --views r/views.csv
    cmp csv/fruits.json full/fruits.json || fail "positions alone give other fruit than a whole views.csv"
    mkdir season && cp -r t season/t1 && cp -r t season/t2
    expect 0 '' scan season/t1/ season/t2 -o many --max-views 1
    [ -f many/t1/fruits.json ] && [ -f many/t2/fruits.json ] || fail "folders in a list: $(ls many)"
    ;;
  outputs)  # what is left out, and what is printed
    small_truss t --total 3 --hidden 0 --seed 1
    expect 0 '' scan t -o r --seed 1 --max-views 2 --json
    python3 - <<'PY' || fail "--json does not list the fruit"
import json
summary = json.load(open("out.txt"))
assert summary["fruits"] == json.load(open("r/fruits.json")) and len(summary["fruits"]) == 3, summary
assert summary["views"] == 2 and summary["stop_reason"] == "max_views" and summary["folder"] == "r"
PY
    expect 0 '' process r/cloud.ply -o bare --no-report --no-picture --quiet
    [ ! -s out.txt ] && [ ! -s err.txt ] || fail "--quiet printed something"
    [ "$(ls bare | tr '\n' ' ')" = 'cloud.ply cloud_raw.ply fruits.csv fruits.json run.json views.csv ' ] || fail "bare: $(ls bare)"
    expect 0 '' process r/cloud.ply -o quiet --quiet --json && python3 -m json.tool out.txt >/dev/null || fail "--quiet --json"
    cmp bare/fruits.json quiet/fruits.json && [ -s quiet/truss.png ] && [ -s quiet/report.html ] || fail "--quiet changes the result"
    expect 0 '' process r/cloud.ply -o bare --force --no-report && [ -s bare/truss.png ] && [ ! -e bare/report.html ] || fail "--no-report"
    expect 0 '' process r/cloud.ply -o bare --force --no-picture && [ ! -e bare/truss.png ] && [ -s bare/report.html ] || fail "--no-picture"
    expect 2 'nodir/x.mcap: cannot be written: No such file or directory' scan t -o early --mcap nodir/x.mcap
    [ ! -e early ] || fail "a scan whose MCAP file cannot be written begins"
    # A scan without pictures is finished, and a later --resume adds them.
    expect 0 '' scan t -o s --seed 1 --max-views 2 --no-picture --no-report --quiet && [ ! -s err.txt ] || fail "--quiet scan"
    expect 0 'nothing to do' scan --resume s --no-picture --no-report
    expect 0 '' scan --resume s && cmp s/truss.png r/truss.png && [ -s s/report.html ] || fail "the pictures of a scan without them"
    ;;
  kinds)  # one thing named where another is wanted
    small_truss t --total 3 --hidden 0 --seed 1
    expect 0 '' scan t -o r --seed 1 --max-views 1 --quiet && expect 0 '' export-views r -o v
    expect 0 '' process r/cloud.ply -o p --quiet --no-report --no-picture && mkdir bare
    for input in t t/scene.yaml; do
      expect 2 "$input: is neither a cloud nor recorded views, but a scene, which .agrisee scan. takes" process $input -o d
    done
    expect 2 'r: is neither .*, but the result of a scan, .*its cloud is cloud.ply' process r -o d
    expect 2 'r/cloud.ply: is not a scene, but a point cloud, which .agrisee process. takes' scan r/cloud.ply -o d
    expect 2 'r/cloud.ply: is not a scene' limit r/cloud.ply -o d && expect 2 'r/cloud.ply: is not a scene' evaluate r/cloud.ply r
    for input in v v/views.yaml; do
      expect 2 "$input: is not a scene, but a list of recorded views .*, which .agrisee process. takes" scan $input -o d
    done
    expect 2 'p: is not the result of a scan, but a result that holds a cloud .cloud.ply. but no frames' export-views p -o d
    expect 2 't: is not the result of a scan, but a scene' export-views t -o d && expect 2 'v: is not the .*, but a list' export-views v -o d
    expect 2 'bare: is not the result of a scan: there is no bare/scan.json' export-views bare -o d
    small_truss other --total 2 --hidden 0 --seed 2 && mv t moved
    expect 2 't/scene.yaml: no such file; name the scene of the scan with --scene' export-views r -o d
    expect 2 'other/scene.yaml: is not the scene of the scan' export-views r --scene other/scene.yaml -o d
    expect 0 '' export-views r --scene moved/scene.yaml -o w && cmp v/depth/0000.png w/depth/0000.png || fail "a moved scene"
    mv moved t && cp -r r open && rm open/cloud.ply
    expect 2 'open: is an unfinished scan; finish it with agrisee scan --resume open' evaluate t open
    expect 2 'gone.yaml: no such file' scan gone.yaml -o d && expect 2 'gone.ply: no such file' process gone.ply -o d
    [ ! -e d ] || fail "a wrong input wrote something"
    expect 0 '' evaluate t r && grep -q '^  id  as    IoU   seen  recall  recall_obs ' out.txt || fail "evaluate: $(cat out.txt)"
    ;;
  words)  # a wrong word is named, with the right one
    for words in "proces a.ply -o b:command 'proces'; did you mean 'process'" \
      "process a.ply --out b:option '--out'; did you mean '--output'" \
      "scan s.yaml -o b --max-veiws=3:option '--max-veiws'; did you mean '--max-views'" \
      "scan s.yaml -o b -x:scan: unknown option '-x'" "--verzion:option '--verzion'; did you mean '--version'" \
      "process a.ply -o b --view v.csv:option '--view'; did you mean '--views'" \
      "xyzzy:unknown command 'xyzzy'\$"; do
      expect 1 "agrisee: .*${words#*:}" ${words%%:*}
    done
    expect 1 'must be 0 or more, got -1' scan s.yaml -o b --seed -1
    expect 1 'must be 0 or more, got -1' make-truss -o b --seed -1
    for command in 'scan s.yaml' 'process c.ply' make-truss make-plant; do
      expect 1 '--seed: must be at most 18446744073709551615, got 99999999999999999999999' $command -o b --seed 99999999999999999999999
    done
    for value in 0 -1 inf nan; do
      expect 1 "--threshold: must be above 0, got $value\$" evaluate t r --threshold $value
    done
    expect 1 '--threshold: must be a number above 0, got x$' evaluate t r --threshold x
    # What does not go together is refused, and so are repeats.
    echo 'preset: paper' >p.yaml
    for command in 'scan s.yaml' 'process c.ply'; do
      expect 1 '--preset see: p.yaml starts from the preset paper' $command -o b --preset see --params p.yaml
    done
    expect 1 '--presets default: p.yaml starts from the preset paper' experiment -o e --scenes 7_1 --params p.yaml
    for replaced in '--presets paper' '--planner gain' '--noise l515'; do
      expect 1 "--groups excludes ${replaced% *}|${replaced% *} excludes --groups" experiment -o e --groups default/gain/none $replaced
    done
    expect 1 '--unfinished excludes --db|--db excludes --unfinished' merge d --unfinished --db d.sqlite
    for option in '--topic /x' '--world-frame y' '--range 0.2,2'; do
      for input in c.ply v/views.yaml v '--depth d.png --intrinsics 1,1,1,1'; do
        expect 1 'is no MCAP file, so leave out --topic, --world-frame and --range' process $input -o b $option
      done
    done
    for range in 2,1:'expected 0 <= minimum' 250,2000:'begins at 250 m: is it in millimetres'; do
      expect 1 "--range: ${range#*:}" process x.mcap -o b --range "${range%%:*}"
    done
    expect 1 '--kinds: any is there twice' faults --report f.md --scenes 7_1 --kinds any,wrong_pose,any
    expect 1 '--rates: 0.1 is there twice' faults --report f.md --scenes 7_1 --rates 0.1,0,0.1
    expect 1 '7_1: there are two scenes with the name truss_07_1' faults --report f.md --scenes truss_07_1,7_1 --rates 0
    [ ! -e b ] && [ ! -e f.md ] || fail "a refused command wrote something"
    expect 1 '^agrisee: .*output is required' process a.ply
    expect 1 '^agrisee: --max-views: ' scan s.yaml -o b --max-views 0 && expect 1 '^agrisee: .*subcommand' && expect 1 '^agrisee: ' scan
    for limit in 'total.*1 - 12' 'leaflets.*0 - 6' 'elongation.*0.5 - 2' 'at most half' '0.005 to 0.06'; do
      "$agrisee" make-truss --help | grep -q -- "$limit" || fail "make-truss --help does not state $limit"
    done
    for word in 'split: {bodies: {fit: {iterations: 2147483647}}}' 'picking: {steps: 2147483647}'; do
      echo "$word" >p.yaml && expect 2 "p.yaml:1: '.*' must be from 1 to 1000, got 2.14748365e\+09" scan s.yaml -o b --params p.yaml
    done
    printf 'gain:\n  min_gian: 1\n' >p.yaml && expect 2 "p.yaml:2: unknown key 'gain.min_gian'; did you mean 'min_gain'" scan s.yaml -o b --params p.yaml
    [ ! -e b ] || fail "a wrong word wrote something"
    ;;
  parameters)  # the template is a parameter file with every key at its default
    printf 'ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n' >none.ply
    for preset in default paper; do
      expect 0 '' parameters --preset $preset && cp out.txt $preset.yaml
      expect 0 '' process none.ply -o $preset --preset $preset --no-picture --no-report
      expect 0 '' process none.ply -o again_$preset --params $preset.yaml --no-picture --no-report
      python3 - $preset <<'PY' || fail "the template of $preset"
import json, re, sys
preset = sys.argv[1]
a, b = (json.load(open(f + preset + "/run.json"))["parameters"] for f in ("", "again_"))
assert a == b
lines = [line for line in open(preset + ".yaml") if not line.startswith("#")]
values = [line for line in lines if not re.fullmatch(r" *\w+:\n", line)]
assert len(values) > 90 and all(re.search(r"  # .{4}", line) for line in values), [v for v in values if "#" not in v]
row = next(line for line in lines if line.startswith("  min_gain:"))
assert "(zero or more)" in row or "(" in row, row
PY
    done
    ;;
  image)  # a single depth image, alone and with masks, boxes and colors
    small_truss t --total 3 --hidden 0 --seed 3
    expect 0 '' scan t -o r --noise none --seed 5 --max-views 1
    expect 0 '' export-views r -o e
    camera=$(python3 -c '
import re
text = open("e/views.yaml").read()
print(",".join(re.search(rf"\b{key}: (\S+)", text).group(1) for key in ("fx", "fy", "cx", "cy")))')
    image="--depth e/depth/0000.png --intrinsics $camera --depth-scale 0.0001"
    expect 0 '' process $image -o plain
    grep -q '"ripeness"' plain/fruits.json && fail "ripeness without colours"
    expect 0 '' process --depth e/depth/0000.png --intrinsics $camera -o tenfold --no-picture --no-report
    grep -qE '^Note: most surfaces are too large for fruit, and the median depth is [3-9][.0-9]* m: is --depth-scale right\?' out.txt || fail "a wrong scale: $(cat out.txt)"
    python3 - <<'PY'
import json, re, struct, zlib
text = open("e/views.yaml").read()
width, height, fx, fy, cx, cy = (float(re.search(rf"\b{key}: (\S+)", text).group(1))
                                 for key in ("width", "height", "fx", "fy", "cx", "cy"))
width, height = int(width), int(height)
fruits = json.load(open("plain/fruits.json"))
assert fruits
def png(path, color, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    open(path, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, color, 0, 0, 0)) +
                           chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b""))
labels, boxes = [bytearray(width) for _ in range(height)], ["instance,score,u,v,width,height"]
for f in fruits:
    x, y, z = f["center_world"]
    u, v, r = fx * x / z + cx, fy * y / z + cy, fx * sum(f["radii"]) / 3 / z
    boxes.append(f"{f['id']},0.9,{u - r + 0.5},{v - r + 0.5},{2 * r},{2 * r}")
    for row in range(height):
        for column in range(width):
            if (row - v) ** 2 + (column - u) ** 2 < r * r:
                labels[row][column] = f["id"]
png("masks.png", 0, labels)
png("color.png", 2, [b"\xc8\x28\x1e" * width] * height)
binary = [bytearray(width) for _ in range(height)]
for u, v in (40, 40), (width - 40, 40), (40, height - 40):
    for row in range(v - 9, v + 9):
        binary[row][u - 9:u + 9] = b"\xff" * 18
png("binary.png", 0, binary)
open("normal.csv", "w").write("u,v,width,height\n0.2,0.3,0.1,0.1\n0.6,0.3,0.1,0.1\n")
header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({width}, {height}), }}\n".encode()
open("turned.npy", "wb").write(b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header +
                               struct.pack("<f", 0.5) * (width * height))
height -= 1
png("small.png", 0, labels[1:])
open("boxes.csv", "w").write("\n".join(boxes) + "\n")
PY
    expect 0 '' process $image --masks masks.png --color color.png -o masked
    grep -q '"class": "red"' masked/fruits.json || fail "no ripeness by colour"
    grep -q '"found_by": "mask"' masked/fruits.json || fail "no body by a mask"
    expect 0 '' process $image --boxes boxes.csv -o boxed
    for f in masked boxed; do
      [ "$(grep -c '"id"' $f/fruits.json)" = "$(grep -c '"id"' plain/fruits.json)" ] || fail "$f: another number of fruit"
    done
    expect 0 '' process $image --masks binary.png -o binary --no-picture --no-report
    grep -q '^Note: instance 255 of the masks lies in .* places far apart: does it stand for all fruit' out.txt || fail "a binary mask: $(cat out.txt)"
    expect 2 'depth/0000.png: holds [0-9]+ instances, which are no masks: is it a depth image' process $image --masks e/depth/0000.png -o x
    expect 2 'normal.csv: all boxes are smaller than a pixel: are they normalized' process $image --boxes normal.csv -o x
    expect 0 '' process --depth turned.npy --intrinsics $camera -o turned --no-picture --no-report
    grep -qE '^Note: the principal point, .* 384 x 512, but in that of one of 512 x 384: is the image transposed' out.txt || fail "a transposed image: $(cat out.txt)"
    expect 2 'small.png: is damaged|small.png: .*pixels, but the depth image' process $image --masks small.png -o x
    expect 2 'has colors or opacity' process $image --masks color.png -o x
    expect 2 'no such file' process $image --color none.png -o x
    expect 2 'depth needs 16' process --depth masks.png --intrinsics $camera -o x
    expect 1 'needs --intrinsics' process --depth e/depth/0000.png -o x
    expect 1 'not both' process e $image -o x
    expect 1 'an input is needed' process -o x
    [ -e x ] && fail "a result of bad input"
    # The same channels of recorded views.
    sed -i 's|^  - depth: .*|&\n    color: ../color.png\n    masks: ../masks.png|' e/views.yaml
    expect 0 '' process e -o views
    grep -q '"class": "red"' views/fruits.json || fail "views.yaml: no ripeness"
    sed -i 's|masks.png|none.png|' e/views.yaml
    expect 2 'views.yaml:[0-9]+: views\[0\].masks: no such file' process e -o x
    ;;
  interrupted)  # a scan that is stopped says how to go on, and keeps what it has
    small_truss t --total 4 --hidden 1 --seed 3
    expect 0 '' scan t -o whole --noise rough --seed 5 --max-views 8
    for signal in INT TERM; do
      rm -rf "r d"
      python3 - "$agrisee" $signal <<'PY' || fail "SIG$signal"
import os, signal, subprocess, sys, time
number = getattr(signal, "SIG" + sys.argv[2])
scan = subprocess.Popen([sys.argv[1], "scan", "t", "-o", "r d", "--noise", "rough", "--seed", "5", "--max-views", "8"],
                        stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
                        preexec_fn=lambda: signal.signal(number, signal.SIG_DFL))
while scan.poll() is None and not os.path.exists("r d/views/0001.view"):
    time.sleep(0.002)
scan.send_signal(number)
error = scan.communicate()[1]
assert scan.returncode == -number, (scan.returncode, error)
assert "interrupted; continue with `agrisee scan --resume 'r d'`" in error, error
PY
      expect 1 "not finished.*--resume 'r d'.*--force.*deletes" scan t -o "r d"
      expect 0 '' scan --resume "r d" && cmp "r d/fruits.json" whole/fruits.json || fail "SIG$signal: another result"
      expect 1 'already holds a result.*--force' scan t -o "r d"
    done
    ;;
  *) fail "unknown case $3" ;;
esac
