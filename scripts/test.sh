#!/usr/bin/env bash
# From a bare clone to tested: installs packages, builds everything, runs every test.
# Usage: scripts/test.sh [--fast] [--no-gpu] [-DNAME=VALUE...]     --fast leaves out the long trainings (label slow),
# --no-gpu the tests on a CUDA device (label gpu; without a device they skip); -D goes to CMake
set -euo pipefail
cd "$(dirname "$0")/.."
excluded=() definitions=()
for option in "$@"; do
  case "$option" in
    --fast) excluded+=(slow) ;;
    --no-gpu) excluded+=(gpu); definitions+=(-DALIGNGS_BUILD_GPU_TESTS=OFF) ;;
    -D?*) definitions+=("$option") ;;
    -h|--help) sed -n '2,4p' "$0" | cut -c3-; exit 0 ;;
    *) echo "test.sh: unknown option $option" >&2; exit 2 ;;
  esac
done
selection=()
if [ ${#excluded[@]} -gt 0 ]; then
  selection=(-LE "$(IFS='|'; echo "${excluded[*]}")")
fi
scripts/setup.sh
scripts/check_layering.sh
scripts/check_prose.sh
scripts/check_docs.py
scripts/build.sh build -DCMAKE_BUILD_TYPE=Release -DALIGNGS_BUILD_TESTS=ON -DALIGNGS_UNITY_BUILD=ON "${definitions[@]}"
# In parallel: most use one core, and each process has a folder of temporary files to itself (tests/test_main.cpp).
ctest --test-dir build --parallel "$(nproc)" --output-on-failure --no-tests=error "${selection[@]}"
