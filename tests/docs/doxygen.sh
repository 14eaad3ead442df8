#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Every public name has a docstring that Doxygen understands. Usage: doxygen.sh OUTPUT; 77 where Doxygen is missing.
set -euo pipefail
output=$(realpath -m "$1")  # before the folder changes
cd "$(dirname "$0")/../.."
command -v doxygen >/dev/null 2>&1 || { echo "SKIPPED: doxygen is not installed"; exit 77; }
mkdir -p "$output"
{ cat docs/Doxyfile; echo "OUTPUT_DIRECTORY = $output"; } | doxygen - 2>&1 | tee "$output/log.txt" | tail -50
if grep -E "warning:|error:" "$output/log.txt" >/dev/null; then
  echo "$(grep -cE "warning:|error:" "$output/log.txt") complaints; all of them are in $output/log.txt"
  exit 1
fi
test -s "$output/html/index.html"
