#!/bin/sh
# Runs every fuzz target for a while: tests/fuzz/run.sh [SECONDS EACH] [BUILD FOLDER]
# A finding stops the script and leaves the input in the corpus folder of its target.
set -eu
seconds=${1:-30}
build=${2:-build/fuzz}
programs=$build/tests/fuzz
corpus=$build/corpus
"$programs/fuzz_seeds" "$corpus"
for target in "$programs"/fuzz_*; do
  name=$(basename "$target")
  if [ "$name" = fuzz_seeds ] || [ ! -x "$target" ] || [ -d "$target" ]; then continue; fi
  echo "== $name"
  if ! "$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=1024 \
    -print_final_stats=1 -artifact_prefix="$corpus/$name/" "$corpus/$name" >"$corpus/$name.log" 2>&1; then
    tail -n 60 "$corpus/$name.log"
    exit 1
  fi
  grep -E 'stat::number_of_executed_units|stat::peak_rss_mb' "$corpus/$name.log"
done
