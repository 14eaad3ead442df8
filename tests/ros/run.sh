#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The ROS 1 node with the simulated robot, as their launch file starts them, against `agrisee scan` on the same scene.
# Usage: run.sh AGRISEE RECORDER PACKAGES WORKDIR CASE; 77 where roslaunch or rosmaster are missing.
agrisee=$1 recorder=$2 case=$5
. "$(dirname "$0")/common.sh" "$3" "$4/$5"

case $case in
  image) output=32FC1 noise=l515 tolerance=0.0005 same_views=1 ;;
  points) output=points noise=l515 tolerance=0.002 same_views=0 ;;
  millimetres) output=16UC1 noise=none tolerance=0.002 same_views=0 ;;
  *) echo "unknown case $case"; exit 2 ;;
esac
printf 'max_views: 6\ngain:\n  dwell: 1\n' >params.yaml  # a whole number for a real one, and a group
make_truss "$agrisee" 5
"$agrisee" scan truss/scene.yaml -o result --noise $noise --seed 1 --params params.yaml 2>/dev/null || exit 1
echo "output: '$work/by_node'" >>params.yaml  # of the node alone

start_master
launch noise:=$noise output:=$output seed:=1 autostart:=false rviz:=false
"$recorder" result $tolerance $same_views &
recording=$!
children+=($recording)
wait -n $launched $recording
code=$?
if kill -0 $recording 2>/dev/null; then
  echo "FAILED: roslaunch has ended"
  code=1
fi
for file in run.json fruits.json cloud.ply report.html truss.png; do # of the only scan that was taken to its end
  [ $code != 0 ] || [ -s by_node/*Z/$file ] || { echo "FAILED: the node has not written $file"; code=1; }
done
[ $code = 0 ] || { echo "--- launch.txt"; tail -n 60 launch.txt; }
exit $code
