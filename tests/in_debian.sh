#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds and tests with the compilers and packages of another Debian release, as root; needs debootstrap and a mirror:
#   tests/in_debian.sh SUITE [COMPILER...]      e.g. tests/in_debian.sh bullseye g++-9 g++-10
# The release is unpacked once, into build/debian/SUITE. TARGETS (default: all) says what to build, TESTS (a regular
# expression; default: all) which of its tests to run.
set -euo pipefail
suite=${1:?usage: tests/in_debian.sh SUITE [COMPILER...]}
compilers=("${@:2}")
[ ${#compilers[@]} -gt 0 ] || compilers=(g++)
cd "$(dirname "$0")/.."
root=$PWD/build/debian/$suite
if [ ! -e "$root/.unpacked" ]; then
  mkdir -p "$root"
  debootstrap --variant=minbase "$suite" "$root" "${MIRROR:-http://deb.debian.org/debian}" \
    /usr/share/debootstrap/scripts/sid
  touch "$root/.unpacked"
fi
in_root() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
install="apt-get install -y -qq --no-install-recommends -o Dpkg::Use-Pty=0"
in_root apt-get update -qq
# shellcheck disable=SC2086
in_root $install cmake ninja-build pkg-config libeigen3-dev libnanoflann-dev libyaml-cpp-dev zlib1g-dev nlohmann-json3-dev \
  libstb-dev catch2 g++ "${compilers[@]}" >/dev/null
cli=ON  # CLI11 came with Debian 12
# shellcheck disable=SC2086
in_root $install libcli11-dev >/dev/null 2>&1 || cli=OFF

rm -rf "$root/src"
mkdir "$root/src"
git ls-files -z --cached --others --exclude-standard | tar -c --null -T - | tar -x -C "$root/src"
for compiler in "${compilers[@]}"; do
  in_root cmake -S /src -B "/build/$compiler" -G Ninja -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_COMPILER=$compiler" \
    -DAGRISEE_WERROR=ON -DAGRISEE_BUILD_ORACLES=OFF -DAGRISEE_BUILD_CLI=$cli
  # shellcheck disable=SC2086
  in_root cmake --build "/build/$compiler" -j "${JOBS:-$(nproc)}" --target ${TARGETS:-all}
  in_root sh -c 'cd "$1" && ctest --output-on-failure -R "$2"' sh "/build/$compiler" "${TESTS:-.}"
done
