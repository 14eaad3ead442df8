# SPDX-License-Identifier: BSD-3-Clause
# What the tests of the command share. Sourced with the arguments AGRISEE WORKDIR CASE; goes to WORKDIR/CASE.
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
# small_truss FOLDER ARGS...: a truss with a sensor that is quickly simulated
small_truss() {
  local folder=$1; shift
  "$agrisee" make-truss "$@" -o "$folder" >/dev/null || fail make-truss
  small_sensor "$folder/scene.yaml"
}
