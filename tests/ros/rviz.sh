#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# RViz, on a screen that is not there, draws a finished scan: rviz.sh AGRISEE PACKAGES WORKDIR; leaves WORKDIR/rviz/rviz.png.
# That it shows anything is judged by its colours: those of the first three fruit have to be there. 77 where RViz, Xvfb or
# ImageMagick are missing.
set -uo pipefail
agrisee=$1 packages=$2 work=$3/rviz
for tool in roslaunch rosmaster rviz Xvfb import convert; do
  command -v $tool >/dev/null || { echo "SKIPPED: no $tool"; exit 77; }
done
export ROS_PACKAGE_PATH=$packages${ROS_PACKAGE_PATH:+:$ROS_PACKAGE_PATH}:/usr/share
rm -rf "$work" && mkdir -p "$work" && cd "$work" || exit 1
"$agrisee" make-truss --total 7 --hidden 1 --seed 1 -o truss >/dev/null || exit 1
sed -i 's/width: *1024/width: 512/; s/height: *768/height: 384/' truss/scene.yaml
printf 'max_views: %s\n' "${MAX_VIEWS:-4}" >params.yaml

Xvfb -displayfd 3 -screen 0 1280x800x24 -nolisten tcp 3>display >/dev/null 2>&1 &
screen=$!
trap 'kill $screen 2>/dev/null' EXIT
for _ in $(seq 50); do [ -s display ] && break; sleep 0.2; done
[ -s display ] || { echo "SKIPPED: Xvfb does not start"; exit 77; }
export DISPLAY=:$(cat display) LIBGL_ALWAYS_SOFTWARE=1 XDG_RUNTIME_DIR=$work HOME=$work
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1 ROS_HOME=$work/ros ROS_LOG_DIR=$work/ros/log
roslaunch -p "$port" agrisee_ros1 demo.launch scene:="$work/truss/scene.yaml" params:="$work/params.yaml" hurry:=4 \
  rviz:=true >launch.txt 2>&1 &
launch=$!
trap 'kill -INT $launch 2>/dev/null; wait $launch 2>/dev/null; kill $screen 2>/dev/null' EXIT

has() { # has R G B: whether some hundred pixels of the picture have this colour, give or take the light
  local n
  n=$(convert rviz.png -fuzz 12% -fill black +opaque "rgb($1,$2,$3)" -fill white -opaque "rgb($1,$2,$3)" \
    -format '%[fx:int(mean*w*h)]' info:)
  [ "$n" -gt 100 ]
}
for _ in $(seq "${PATIENCE:-60}"); do
  kill -0 $launch 2>/dev/null || { tail -n 40 launch.txt; echo "FAILED: roslaunch has ended"; exit 1; }
  sleep 5
  grep -q 'done, ' launch.txt || continue
  sleep "${SETTLE:-5}"
  import -window root rviz.png
  has 226 61 50 && has 42 127 204 && has 245 166 35 && { echo "RViz shows the fruit"; exit 0; }
done
tail -n 40 launch.txt
echo "FAILED: RViz does not show the fruit"
exit 1
