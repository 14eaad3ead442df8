#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Fuzz every target for SECONDS in all, side by side on all cores. The corpus grows in BUILD/corpus and is used again.
# Usage: run.sh BUILD SECONDS [TARGET...]. A finding is written to BUILD/findings, and the exit code is not 0.
set -uo pipefail
build=$1 seconds=$2; shift 2
here=$(cd "$(dirname "$0")" && pwd)
targets=${*:-ply pcd table depth recorded stl obj scene parameters records messages}
cores=$(nproc)
count=$(wc -w <<<"$targets")
each=$((seconds * cores / count)); [ "$each" -gt 0 ] || each=1
mkdir -p "$build/corpus" "$build/findings" "$build/logs"
"$build/write_seeds" "$build/seeds" || exit 1
one() {
  local build=$1 here=$2 each=$3 target=$4
  mkdir -p "$build/corpus/$target"
  local known=(); [ -d "$here/regressions/$target" ] && known=("$here/regressions/$target")
  # A file of 4 KB may cost 64 MB at most in one piece: no reader believes what a header promises.
  local words=(); [ -f "$here/dictionaries/$target.dict" ] && words=(-dict="$here/dictionaries/$target.dict")
  "$build/fuzz_$target" "$build/corpus/$target" "$build/seeds/$target" "${known[@]}" "${words[@]}" \
    -artifact_prefix="$build/findings/$target-" -max_total_time="$each" \
    -max_len=4096 -malloc_limit_mb=64 -rss_limit_mb=2048 -timeout=30 -print_final_stats=1 -detect_leaks=1 \
    >"$build/logs/$target.txt" 2>&1
  local code=$?
  local done cov
  done=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/logs/$target.txt")
  cov=$(grep -oE 'cov: [0-9]+' "$build/logs/$target.txt" | tail -1)
  echo "fuzz $target: ${done:-0} executions in $each s, ${cov:-cov: ?} edges$([ $code = 0 ] || echo ", FOUND SOMETHING (exit $code): see $build/logs/$target.txt")"
  return $code
}
export -f one
printf '%s\n' $targets | xargs -P "$cores" -I{} bash -c 'one "$@"' _ "$build" "$here" "$each" {}
