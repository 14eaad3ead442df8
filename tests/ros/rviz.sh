#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# RViz, on a screen that is not there, draws a finished scan: rviz.sh AGRISEE PACKAGES WORKDIR; leaves WORKDIR/rviz/rviz.png.
# That it shows the fruit is judged by the colours of the first three. 77 where RViz, Xvfb or ImageMagick are missing.
# docs/images/rviz.png: MAX_VIEWS=8 WHEN='moving, 4 views' rviz.sh..., then copy WORKDIR/rviz/rviz.png
agrisee=$1
. "$(dirname "$0")/common.sh" "$2" "$3/rviz" rviz Xvfb import convert

printf 'max_views: %s\n' "${MAX_VIEWS:-3}" >params.yaml
make_truss "$agrisee" 7
Xvfb -displayfd 3 -screen 0 1280x800x24 -nolisten tcp 3>display >/dev/null 2>&1 &
children+=($!)
for _ in $(seq 100); do [ -s display ] && break; sleep 0.2; done
[ -s display ] || { echo "SKIPPED: Xvfb does not start"; exit 77; }
export DISPLAY=:$(cat display) LIBGL_ALWAYS_SOFTWARE=1 XDG_RUNTIME_DIR=$work HOME=$work
start_master
launch rviz:=true

shows() { # shows R G B: whether some hundred pixels of the picture have this colour, give or take the light
  [ "$(convert rviz.png -fuzz 12% -fill black +opaque "rgb($1,$2,$3)" -fill white -opaque "rgb($1,$2,$3)" \
    -format '%[fx:int(mean*w*h)]' info:)" -gt 100 ]
}
for _ in $(seq 200); do
  kill -0 $launched 2>/dev/null || { tail -n 40 launch.txt; echo "FAILED: roslaunch has ended"; exit 1; }
  sleep 5
  grep -q "${WHEN:-done, }" launch.txt || continue
  sleep 3
  import -window root rviz.png
  shows 226 61 50 && shows 42 127 204 && shows 245 166 35 && { echo "RViz shows the fruit"; exit 0; }
done
tail -n 40 launch.txt
echo "FAILED: RViz does not show the fruit"
exit 1
