#!/usr/bin/env bash
# Looks for faults with clang-tidy, by .clang-tidy. Usage: scripts/tidy.sh [FILES...]
# Without FILES: the sources that differ from the branch main, or all of them on main itself.
set -euo pipefail
cd "$(dirname "$0")/.."
program=$(command -v clang-tidy-14 || true)
if [ -z "$program" ]; then
  echo "tidy.sh: clang-tidy-14 is missing: apt-get install clang-tidy-14" >&2
  exit 3
fi
if [ $# -gt 0 ]; then
  files=("$@")
else
  mapfile -t files < <(git diff --name-only --diff-filter=d main -- 'src/*.cpp')
  if [ ${#files[@]} -eq 0 ]; then
    mapfile -t files < <(git ls-files 'src/*.cpp' | grep -v -e '_test\.cpp$' -e '/cuda/' -e '^src/device/')
  fi
fi
# A folder of its own: clang does not read the precompiled headers of GCC.
cmake -S . -B build/tidy -G Ninja -DALIGNGS_PRECOMPILED_HEADERS=OFF -DALIGNGS_WITH_CUDA=OFF -DALIGNGS_BUILD_TESTS=OFF \
  -DALIGNGS_BUILD_BENCHMARKS=OFF >/dev/null
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(nproc)" "$program" -p build/tidy --quiet
