#!/usr/bin/env bash
# Configures and builds one tree. Usage: scripts/build.sh FOLDER [--target NAME]... [cmake arguments...]
set -euo pipefail
cd "$(dirname "$0")/.."
folder=$1
shift
targets=()
while [ "${1:-}" = --target ]; do
  targets+=(--target "$2")
  shift 2
done
# Objects of another clone of the same sources are as good as ours: ccache sees paths relative to this tree.
export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1
# Without these, ccache leaves out all sources with precompiled headers.
export CCACHE_SLOPPINESS=pch_defines,time_macros
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! cmake -S . -B "$folder" -G Ninja "$@" >"$log" 2>&1; then
  cat "$log" >&2
  exit 1
fi
# Each line of ninja also tells how long the rest will take.
export NINJA_STATUS='[%f/%t] '
cmake --build "$folder" "${targets[@]}" --parallel "$(nproc)" | python3 -B scripts/build_progress.py "$folder"
