#!/usr/bin/env bash
# A module may include only modules above it. The order is that of docs/architecture.md and design of the tree.
set -euo pipefail
cd "$(dirname "$0")/.."
modules=(core device io scene nn priors refine room synth gaussians engine metrics train mesh edit serve pipeline batch cli)

declare -A rank
for i in "${!modules[@]}"; do rank[${modules[$i]}]=$i; done

status=0
for folder in src/*/; do
  name=$(basename "$folder")
  if [ -z "${rank[$name]+known}" ]; then
    echo "layering: src/$name is not in the list of modules" >&2
    status=1
  fi
done
while read -r file line from to; do
  if [ -z "${rank[$to]+known}" ]; then
    echo "layering: $file:$line includes \"$to/...\", which is no module" >&2
    status=1
  elif [ "${rank[$to]}" -gt "${rank[$from]}" ]; then
    echo "layering: $file:$line: $from may not include $to" >&2
    status=1
  fi
done < <(grep -rnE '^#include "[a-z_]+/' src/*/ --include='*.h' --include='*.cpp' --include='*.cu' --include='*.cuh' |
         sed -E 's!^(src/([^/]+)/[^:]*):([0-9]+):#include "([a-z_]+)/.*!\1 \3 \2 \4!')
# The program uses no helper of tests; the two engines share formulas/, losses/ and shared/ alone. Tests compare them.
product=$(grep -rnE '^#include "' src --include='*.h' --include='*.cpp' --include='*.cu' --include='*.cuh' |
          grep -vE '^[^:]*(_test\.(cpp|cu)|/testing/[^:]*):')
if grep -E '#include "([a-z_]+/)*testing/' <<<"$product"; then
  echo "layering: the program may not include a helper of tests" >&2
  status=1
fi
if grep -E '^src/engine/cuda/.*"engine/(cpu|reference)/|^src/engine/(cpu|reference)/.*"engine/cuda/|^src/engine/shared/.*"engine/(cpu|cuda|reference)/' <<<"$product"; then
  echo "layering: an engine may not include another; put what they share into src/engine/shared" >&2
  status=1
fi
[ $status -eq 0 ] && echo "layering: ok"
exit $status
