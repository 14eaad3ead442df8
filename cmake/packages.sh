#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing of Debian's or Ubuntu's packages: cmake/packages.sh GROUP...
# Says what it does; asks sudo only when there is something to install and the caller is not root.
set -euo pipefail

declare -A groups=(
  [build]="g++ cmake ninja-build libeigen3-dev libnanoflann-dev libyaml-cpp-dev zlib1g-dev nlohmann-json3-dev libcli11-dev libstb-dev libsqlite3-dev"
  [test]="catch2 pkg-config python3"
  [oracles]="libpcl-dev libopen3d-dev liborocos-kdl-dev libembree-dev"
  [viewers]="cloudcompare meshlab xvfb xauth"
  [bench]="libbenchmark-dev"
  [docs]="doxygen"
  [ros]="libroscpp-dev libtf2-ros-dev libtf2-msgs-dev libgeometry-msgs-dev libsensor-msgs-dev libstd-msgs-dev libstd-srvs-dev \
libtrajectory-msgs-dev libvisualization-msgs-dev python3-roslaunch python3-rosmaster rosout python3-rosservice \
ros-robot-state-publisher rviz"
  [ros2]="python3-rosidl rosidl-generator-c-cpp librosidl-runtime-c-cpp-dev librosidl-typesupport-interface-dev python3-empy python3-lark python3-yaml"
  [cluster]="slurm-wlm munge parallel"
  [shells]="zsh fish"
  [python]="pybind11-dev python3-numpy python3-pytest mypy"
  [fuzz]="clang"
  [format]="clang-format-14"
)
wanted=()
for group in "$@"; do
  [ -n "${groups[$group]:-}" ] || { echo "packages.sh: unknown group '$group' (${!groups[*]})" >&2; exit 1; }
  for package in ${groups[$group]}; do wanted+=("$package"); done
done
if ! command -v dpkg-query >/dev/null 2>&1; then
  echo "packages.sh: not a Debian or Ubuntu machine; please install the counterparts of: ${wanted[*]}"
  exit 0
fi
missing=()
for package in "${wanted[@]}"; do
  [ "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null)" = "install ok installed" ] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0
echo "packages.sh: installing ${missing[*]}"
root=()
[ "$(id -u)" = 0 ] || root=(sudo)
export DEBIAN_FRONTEND=noninteractive
"${root[@]}" apt-get update -qq
"${root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
