#!/usr/bin/env bash
# From a bare clone to a reconstructed, labelled room: installs packages, builds, runs the demo.
# Usage: scripts/demo.sh [options of `aligngs demo`]     results: demo_run/report.html
# ALIGNGS_WITH_CUDA=ON or OFF decides about CUDA; without it, it is built where an NVIDIA driver is.
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)
"$here/scripts/setup.sh"
cuda=${ALIGNGS_WITH_CUDA:-AUTO}
if [ "$cuda" = AUTO ] && ! compgen -G '/dev/nvidia[0-9]*' >/dev/null && [ ! -e /dev/dxg ]; then
  cuda=OFF  # a third of the time of a build, for nothing here
  echo "demo.sh: no NVIDIA driver here, so CUDA is left out (ALIGNGS_WITH_CUDA=ON builds it anyway)"
elif [ "$cuda" = AUTO ]; then
  export CUDAARCHS=${CUDAARCHS:-native}
fi
echo "demo.sh: 1 of 2: building with $(nproc) processors; the time that is left follows"
"$here/scripts/build.sh" build -DCMAKE_BUILD_TYPE=Release -DALIGNGS_BUILD_TESTS=OFF -DALIGNGS_BUILD_BENCHMARKS=OFF \
  -DALIGNGS_UNITY_BUILD=ON "-DALIGNGS_WITH_CUDA=$cuda"
echo "demo.sh: 2 of 2: reconstructing a synthetic room"
exec "$here/build/aligngs" demo "$@"
