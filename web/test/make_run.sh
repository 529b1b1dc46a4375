#!/bin/sh
# The small run that the page's tests look at: FOLDER/run, of FOLDER/scene. Its Gaussians are few, as they are drawn
# without a graphics card. Usage: make_run.sh PROGRAM FOLDER. Status 77: skipped, as nothing will look at it.
command -v node >/dev/null || { echo "skipped: node is not installed (scripts/setup.sh --browser)"; exit 77; }
set -e
rm -rf "$2"
"$1" synth "$2/scene" --size 160x120 --views 14 --test-views 2 --teacher exact -q
"$1" run "$2/scene" -o "$2/run" -n 150 -q --set mesh.voxel=0.04 --set init.max_gaussians=12000 --set densify.max_gaussians=14000
