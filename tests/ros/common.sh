# SPDX-License-Identifier: BSD-3-Clause
# For run.sh and rviz.sh: a truss, and a ROS of our own that goes when the script does. Sets `work` and goes there.
# Usage: . common.sh PACKAGES WORKDIR TOOLS...; 77 where one of the tools is missing.
set -uo pipefail
packages=$1 work=$2
for tool in roslaunch rosmaster "${@:3}"; do
  command -v "$tool" >/dev/null || { echo "SKIPPED: no $tool"; exit 77; }
done
rm -rf "$work" && mkdir -p "$work" && cd "$work" || exit 1
export ROS_PACKAGE_PATH=$packages${ROS_PACKAGE_PATH:+:$ROS_PACKAGE_PATH}:/usr/share

children=()
stop_children() {
  local i
  for ((i = ${#children[@]} - 1; i >= 0; --i)); do
    kill "${children[i]}" 2>/dev/null
    wait "${children[i]}" 2>/dev/null
  done
}
trap stop_children EXIT

make_truss() { # make_truss AGRISEE FRUIT: truss/scene.yaml, with a sensor that does not take long
  "$1" make-truss --total "$2" --hidden 1 --seed 1 -o truss >/dev/null || exit 1
  sed -i 's/width: *1024/width: 512/; s/height: *768/height: 384/' truss/scene.yaml
}

start_master() { # on a port that nobody uses; roslaunch's own gives up after ten seconds, which a busy machine may need
  local port
  port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
  export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1 ROS_HOME=$work/ros ROS_LOG_DIR=$work/ros/log
  export ROSCONSOLE_STDOUT_LINE_BUFFERED=1  # for those who wait for a line
  rosmaster --core -p "$port" >master.txt 2>&1 &
  children+=($!)
  for _ in $(seq 120); do
    (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null && return
    sleep 0.5
  done
  cat master.txt
  echo "FAILED: no ROS master"
  exit 1
}

launch() { # launch ARGUMENTS...: the demonstration, its pid in `launched`
  roslaunch agrisee_ros1 demo.launch scene:="$work/truss/scene.yaml" params:="$work/params.yaml" hurry:=4 "$@" \
    >launch.txt 2>&1 &
  launched=$!
  children+=($launched)
}
