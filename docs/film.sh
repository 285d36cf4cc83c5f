#!/bin/sh
# SPDX-License-Identifier: MIT
# Makes docs/film.webp and docs/page.webp, the film and the picture of README.md, from runs that it records:
#   COOPDYN_BINARY=build/release/coopdyn docs/film.sh        (needs the Debian package webp)
set -eu
coopdyn=$(realpath "${COOPDYN_BINARY:-build/release/coopdyn}")
docs=$(dirname "$(realpath "$0")")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
export COOPDYN_PATH="${COOPDYN_PATH:-$docs/..}"

# scene NUMBER SCENARIO SECONDS SPEED EYE LOOK
scene() {
  "$coopdyn" serve "$2" --mode free --duration "$3" --record "$2.run" --no-net
  "$coopdyn" export "$2.run" --to png --fps 12 --speed "$4" --size 640x320 --eye "$5" --look "$6" --out "scene$1"
}
scene 1 reach 12 3 1.3,-2.1,1.3 -0.75,-0.1,0.35
scene 2 walk 8 2 1.1,-2.5,1.1 -0.75,0,0.42
scene 3 flock50 60 12 0,-8.5,6.5 0,-0.9,0
scene 4 formation_loaded 36 9 1,-6,5 1.1,0.2,0
img2webp -loop 0 -d 83 -lossy -q 60 -m 6 ./scene*/*.png -o "$docs/film.webp"
COOPDYN_BINARY=$coopdyn node "$docs/../tests/page/readme_picture.js" formation_loaded.run "$docs/page.webp"
ls -l "$docs/film.webp" "$docs/page.webp"
