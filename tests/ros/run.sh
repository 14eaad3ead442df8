#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The ROS 1 node with the simulated robot, as their launch file starts them, against `agrisee scan` on the same scene.
# Usage: run.sh AGRISEE RECORDER PACKAGES WORKDIR CASE; 77 where roslaunch or robot_state_publisher are missing.
set -uo pipefail
agrisee=$1 recorder=$2 packages=$3 work=$4/$5
command -v roslaunch >/dev/null && command -v rosmaster >/dev/null || { echo "SKIPPED: no roslaunch"; exit 77; }
export ROS_PACKAGE_PATH=$packages${ROS_PACKAGE_PATH:+:$ROS_PACKAGE_PATH}:/usr/share
rm -rf "$work" && mkdir -p "$work" && cd "$work" || exit 1

case $5 in
  image) output=32FC1 noise=l515 tolerance=0.0005 same_views=1 ;;
  points) output=points noise=l515 tolerance=0.002 same_views=0 ;;
  millimetres) output=16UC1 noise=none tolerance=0.002 same_views=0 ;;
  *) echo "unknown case $5"; exit 2 ;;
esac
printf 'max_views: 8\ngain:\n  dwell: 1\n' >params.yaml  # a whole number for a real one, and a group
"$agrisee" make-truss --total 5 --hidden 1 --seed 1 -o truss >/dev/null || exit 1
sed -i 's/width: *1024/width: 512/; s/height: *768/height: 384/' truss/scene.yaml
"$agrisee" scan truss/scene.yaml -o result --noise $noise --seed 1 --params params.yaml 2>/dev/null || exit 1

port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1 ROS_HOME=$work/ros ROS_LOG_DIR=$work/ros/log
roslaunch -p "$port" agrisee_ros1 demo.launch scene:="$work/truss/scene.yaml" params:="$work/params.yaml" noise:=$noise \
  output:=$output seed:=1 hurry:=4 autostart:=false rviz:=false >launch.txt 2>&1 &
launch=$!
trap 'kill -INT $launch 2>/dev/null; wait $launch 2>/dev/null' EXIT
for _ in $(seq 100); do
  kill -0 $launch 2>/dev/null || break
  (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null && break
  sleep 0.2
done
timeout 500 "$recorder" result $tolerance $same_views
code=$?
[ $code = 0 ] || { echo "--- launch.txt"; tail -n 60 launch.txt; }
exit $code
