#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes the Debian packages and looks into them: debian.sh CPACK BUILD_TREE WORK VERSION WITH_TOOL [PYTHON]
# PYTHON: the interpreter for which the Python module was built, if it was.
set -euo pipefail
cpack=$1 build=$2 work=$3 version=$4 with_tool=$5 python=${6:-}
for needed in dpkg-deb dpkg-shlibdeps; do
  command -v $needed >/dev/null || { echo "skipped: no $needed"; exit 77; }
done
rm -rf "$work"
mkdir -p "$work/root"
(cd "$build" && "$cpack" -G DEB -B "$work")
packages=(libagrisee-dev)
case $with_tool in ON|1|TRUE) packages+=(agrisee) ;; esac
if [ -n "$python" ]; then packages+=(python3-agrisee); fi
for package in "${packages[@]}"; do
  file=$(ls "$work/${package}_${version}"_*.deb)
  [ "$(dpkg-deb -f "$file" Version)" = "$version" ]
  [ -n "$(dpkg-deb -f "$file" Depends)" ]
  dpkg-deb -x "$file" "$work/root"
  test -f "$work/root/usr/share/doc/$package/copyright"
done
test -f "$work/root/usr/include/agrisee/agrisee.hpp"
find "$work/root/usr" -name agrisee-config.cmake | grep -q .
case $with_tool in ON|1|TRUE)
  [ "$("$work/root/usr/bin/agrisee" --version | head -n 1)" = "agrisee $version" ]
  for file in bash-completion/completions/agrisee zsh/vendor-completions/_agrisee fish/vendor_completions.d/agrisee.fish; do
    test -s "$work/root/usr/share/$file"
  done
  grep -q '^\.SS scan' "$work/root/usr/share/man/man1/agrisee.1"
  if command -v man >/dev/null; then  # it has no line that troff complains of
    [ -z "$(MANROFFSEQ= man --warnings -l "$work/root/usr/share/man/man1/agrisee.1" 2>&1 >/dev/null)" ]
  fi
  ! dpkg-deb -c "$work/agrisee_${version}"_*.deb | grep -q include
esac
if [ -n "$python" ]; then
  dpkg-deb -f "$work/python3-agrisee_${version}"_*.deb Depends | grep -q python3-numpy
  module=$work/root/usr/lib/python3/dist-packages
  [ "$(PYTHONPATH=$module "$python" -B -c 'import agrisee; print(agrisee.__version__)')" = "$version" ]
fi
