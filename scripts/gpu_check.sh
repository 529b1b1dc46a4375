#!/usr/bin/env bash
# Everything that only an NVIDIA device can show, in one command and at most nine minutes after the build: operations,
# networks, tests, a whole training and the time of every choice of kernel.
# Usage: scripts/gpu_check.sh [--built FOLDER] [--emulated] [--out FOLDER] [--minutes N] [--only PART]
# Results: FOLDER/gpu_check.json and FOLDER/gpu_check.md (default gpu_check). Each part is reported on its own.
# --built takes a build folder as it is; --emulated runs what it can on the emulation of a device, for machines without one.
set -euo pipefail
cd "$(dirname "$0")/.."
built='' arguments=()
while [ $# -gt 0 ]; do
  case "$1" in
    --built) built=${2:?--built needs a folder}; shift ;;
    -h|--help) sed -n '2,6p' "$0" | cut -c3-; exit 0 ;;
    *) arguments+=("$1") ;;
  esac
  shift
done
if [ -z "$built" ]; then
  built=build
  scripts/setup.sh
  mapfile -t cuda < <(scripts/cuda_options.sh)
  CUDAARCHS=${CUDAARCHS:-native} scripts/build.sh build -DCMAKE_BUILD_TYPE=Release -DALIGNGS_BUILD_TESTS=ON -DALIGNGS_BUILD_GPU_TESTS=ON "${cuda[@]}"
fi
exec python3 -B scripts/gpu_check.py --built "$built" "${arguments[@]}"
