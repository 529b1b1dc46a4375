#!/usr/bin/env bash
# From a bare clone to tested: installs packages, builds everything, runs every test.
# Usage: scripts/test.sh [--fast]     --fast leaves out the long trainings (label slow)
set -euo pipefail
cd "$(dirname "$0")/.."
selection=()
for option in "$@"; do
  case "$option" in
    --fast) selection=(-LE slow) ;;
    -h|--help) sed -n '2,3p' "$0" | cut -c3-; exit 0 ;;
    *) echo "test.sh: unknown option $option" >&2; exit 2 ;;
  esac
done
scripts/setup.sh
scripts/check_layering.sh
scripts/build.sh build -DCMAKE_BUILD_TYPE=Release -DALIGNGS_BUILD_TESTS=ON
# One test at a time: most of them use every core themselves.
ctest --test-dir build --output-on-failure --no-tests=error "${selection[@]}"
