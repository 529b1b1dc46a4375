#!/usr/bin/env bash
# Formats C++ and CUDA sources by .clang-format. Usage: scripts/format.sh [--check] [FILES...]
# Without FILES: all of them. --check changes nothing, and names the files that differ with status 1.
set -euo pipefail
cd "$(dirname "$0")/.."
mode=(-i)
if [ "${1:-}" = --check ]; then
  mode=(--dry-run --Werror)
  shift
elif [ "${1:-}" = -h ] || [ "${1:-}" = --help ]; then
  sed -n '2,3p' "$0" | cut -c3-
  exit 0
fi
# Versions of clang-format differ in their results, so one is named.
program=$(command -v clang-format-14 || true)
if [ -z "$program" ]; then
  echo "format.sh: clang-format-14 is missing: apt-get install clang-format-14" >&2
  exit 3
fi
if [ $# -gt 0 ]; then
  files=()
  for file in "$@"; do
    case "$file" in
      *.cpp | *.h | *.cu | *.cuh) files+=("$file") ;;
      *) echo "format.sh: $file is no C++ source: left as it is" >&2 ;;
    esac
  done
  [ ${#files[@]} -gt 0 ] || exit 0
else
  mapfile -t files < <(git ls-files '*.cpp' '*.h' '*.cu' '*.cuh')
fi
printf '%s\0' "${files[@]}" | xargs -0 -n 40 -P "$(nproc)" "$program" "${mode[@]}"
