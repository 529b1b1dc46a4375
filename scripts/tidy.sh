#!/usr/bin/env bash
# Looks for faults with clang-tidy, by .clang-tidy. Usage: scripts/tidy.sh [--all | FILES...]
# Without FILES: the sources that differ from the branch main, or all of them where none does. --all takes all of them.
# All sources are read as a unity build with one group for each module, which takes a fourth of the time.
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in -h|--help) sed -n '2,4p' "$0" | cut -c3-; exit 0 ;; esac
program=$(command -v clang-tidy-14 || true)
if [ -z "$program" ]; then
  echo "tidy.sh: clang-tidy-14 is missing: apt-get install clang-tidy-14" >&2
  exit 3
fi
files=()
if [ "${1:-}" = --all ]; then
  [ $# -eq 1 ] || { echo "tidy.sh: --all takes no files" >&2; exit 2; }
elif [ $# -gt 0 ]; then
  for file in "$@"; do [ -f "$file" ] || { echo "tidy.sh: there is no file $file" >&2; exit 2; }; done
  files=("$@")
else
  mapfile -t files < <(git diff --name-only --diff-filter=d main -- 'src/*.cpp')
fi

# Folders of their own: clang does not read the precompiled headers of GCC.
unity=OFF folder=build/tidy/files
[ ${#files[@]} -gt 0 ] || { unity=ON folder=build/tidy/modules; }
cmake -S . -B "$folder" -G Ninja -DALIGNGS_PRECOMPILED_HEADERS=OFF "-DALIGNGS_UNITY_BUILD=$unity" \
  -DALIGNGS_UNITY_GROUP=0 -DALIGNGS_WITH_CUDA=OFF -DALIGNGS_BUILD_TESTS=OFF -DALIGNGS_BUILD_BENCHMARKS=OFF >/dev/null
if [ ${#files[@]} -eq 0 ]; then
  # Modules, and sources that are compiled alone.
  mapfile -t files < <(sed -n 's/^  "file": "\(.*\)",\{0,1\}$/\1/p' "$folder/compile_commands.json" |
                       grep -e '/unity_[0-9]*_cxx\.cxx$' -e "^$PWD/src/")
fi

# Findings of one source at a time, and nothing else.
look() {
  local output
  if ! output=$("$1" -p "$2" --quiet "$3" 2>&1); then
    grep -v -e ' warnings\{0,1\} generated\.$' -e ' warnings\{0,1\} treated as errors\{0,1\}$' <<<"$output"
    return 1
  fi
}
export -f look
if ! printf '%s\0' "${files[@]}" | xargs -0 -I '{}' -P "$(nproc)" bash -c 'look "$@"' look "$program" "$folder" '{}'; then
  echo "tidy.sh: clang-tidy found faults: mend them, or say with NOLINT(CHECK) why one is none" >&2
  exit 1
fi
echo "tidy.sh: no faults in ${#files[@]} files or modules"
