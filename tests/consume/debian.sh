#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes the Debian packages and looks into them: debian.sh CPACK BUILD_TREE WORK VERSION WITH_TOOL
set -euo pipefail
cpack=$1 build=$2 work=$3 version=$4 with_tool=$5
for needed in dpkg-deb dpkg-shlibdeps; do
  command -v $needed >/dev/null || { echo "skipped: no $needed"; exit 77; }
done
rm -rf "$work"
mkdir -p "$work/root"
(cd "$build" && "$cpack" -G DEB -B "$work")
packages=(libagrisee-dev)
case $with_tool in ON|1|TRUE) packages+=(agrisee) ;; esac
for package in "${packages[@]}"; do
  file=$(ls "$work/${package}_${version}"_*.deb)
  [ "$(dpkg-deb -f "$file" Version)" = "$version" ]
  [ -n "$(dpkg-deb -f "$file" Depends)" ]
  dpkg-deb -x "$file" "$work/root"
  test -f "$work/root/usr/share/doc/$package/copyright"
done
test -f "$work/root/usr/include/agrisee/agrisee.hpp"
find "$work/root/usr" -name agrisee-config.cmake | grep -q .
if [ ${#packages[@]} = 2 ]; then
  [ "$("$work/root/usr/bin/agrisee" --version)" = "agrisee $version" ]
  ! dpkg-deb -c "$work/agrisee_${version}"_*.deb | grep -q include
fi
