#!/usr/bin/env bash
# From a bare clone to a reconstructed, labelled room: installs packages, builds, runs the demo.
# Usage: scripts/demo.sh [options of `aligngs demo`]     results: demo_run/report.html
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)
"$here/scripts/setup.sh"
"$here/scripts/build.sh" build -DCMAKE_BUILD_TYPE=Release -DALIGNGS_BUILD_TESTS=OFF -DALIGNGS_BUILD_BENCHMARKS=OFF
exec "$here/build/aligngs" demo "$@"
