#!/usr/bin/env bash
# From a bare clone to tested: installs packages, builds everything, runs every test.
# Usage: scripts/test.sh [--fast] [--no-gpu] [--require-all] [-DNAME=VALUE...]     --fast leaves out the long trainings
# (label slow), --no-gpu the tests on a CUDA device (label gpu; without a device they skip); -D goes to CMake.
# --require-all, or ALIGNGS_REQUIRE_ALL=1: a test that was skipped fails, unless tests/allowed_skips.txt has its reason
set -euo pipefail
cd "$(dirname "$0")/.."
excluded=() definitions=()
require_all=${ALIGNGS_REQUIRE_ALL:-0}
for option in "$@"; do
  case "$option" in
    --fast) excluded+=(slow) ;;
    --no-gpu) excluded+=(gpu); definitions+=(-DALIGNGS_BUILD_GPU_TESTS=OFF) ;;
    --require-all) require_all=1 ;;
    -D?*) definitions+=("$option") ;;
    -h|--help) sed -n '2,5p' "$0" | cut -c3-; exit 0 ;;
    *) echo "test.sh: unknown option $option" >&2; exit 2 ;;
  esac
done
selection=()
if [ ${#excluded[@]} -gt 0 ]; then
  selection=(-LE "$(IFS='|'; echo "${excluded[*]}")")
fi
scripts/setup.sh
scripts/check_layering.sh
scripts/check_names.py
scripts/check_names_test.py
scripts/check_prose.sh
scripts/check_docs.py
scripts/build.sh build -DCMAKE_BUILD_TYPE=Release -DALIGNGS_BUILD_TESTS=ON -DALIGNGS_UNITY_BUILD=ON "${definitions[@]}"
# In parallel: most use one core, and each process has a folder of temporary files to itself (tests/test_main.cpp).
ctest --test-dir build --parallel "$(nproc)" --output-on-failure --no-tests=error \
  --output-junit test_results.xml "${selection[@]}"
if [ "$require_all" = 1 ]; then
  scripts/check_skips.py build/test_results.xml
fi
