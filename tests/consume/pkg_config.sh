#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Compiles the consumer by hand with what pkg-config says:
#   pkg_config.sh PREFIX LIBDIR COMPILER WORK VERSION agrisee|agrisee-io
set -euo pipefail
prefix=$1 libdir=$2 compiler=$3 work=$4 version=$5 package=$6
sources=$(cd "$(dirname "$0")" && pwd)
command -v pkg-config >/dev/null || { echo "skipped: no pkg-config"; exit 77; }
for needed in eigen3 nanoflann; do
  pkg-config --exists $needed || { echo "skipped: $needed has no pkg-config file here"; exit 77; }
done
export PKG_CONFIG_PATH=$prefix/$libdir/pkgconfig
[ "$(pkg-config --modversion "$package")" = "$version" ]
define=(-DWITH_METHOD)
[ "$package" = agrisee ] || define+=(-DWITH_IO)
mkdir -p "$work"
# shellcheck disable=SC2046
$compiler -std=c++17 -O0 "${define[@]}" "$sources"/main.cpp "$sources"/other.cpp -o "$work/consumer" \
  $(pkg-config --cflags --libs "$package")
"$work/consumer" | grep -F "agrisee $version:"
