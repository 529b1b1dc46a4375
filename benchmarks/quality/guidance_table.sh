#!/usr/bin/env bash
# Does guidance help? One synthetic room with simulated teachers, several seeds (each another draw of the teachers and of
# the training), four rows: photometric only, preset paper, preset default, and the TSDF of the same prior depth with
# the same poses. Prints a Markdown table of means and standard deviations over the seeds.
#
# Usage: benchmarks/quality/guidance_table.sh OUTPUT [ITERATIONS] [SEEDS] [ROOM]
#   OUTPUT      folder for scenes, runs and results.csv; finished runs in it are not repeated
#   ITERATIONS  of every training (default 1000)    SEEDS  e.g. "1 2 3" (default)    ROOM  default bedroom
# ALIGNGS names the program (default build/aligngs).
set -euo pipefail
program=${ALIGNGS:-$(dirname "$0")/../../build/aligngs}
output=${1:?usage: guidance_table.sh OUTPUT [ITERATIONS] [SEEDS] [ROOM]}
iterations=${2:-1000}
seeds=${3:-1 2 3}
room=${4:-bedroom}
mkdir -p "$output"

# row name | options of `aligngs run`
rows=(
  "photometric only|--set data.prior_depth=none --set data.semantics=false"
  "preset paper|--preset paper"
  "preset default|--preset default"
)

# The figures of a summary as PSNR,SSIM,F,precision,recall,mIoU ("nan" where there is none).
figures() {
  awk '/^novel views/ {psnr=$4; for (i=1;i<=NF;i++) if ($i=="SSIM") ssim=$(i+1)}
       /^geometry/ {f=$3; for (i=1;i<=NF;i++) {if ($i=="(precision") p=$(i+1); if ($i=="recall") r=$(i+1)}}
       /^labels +mIoU/ {miou=$3}
       END {gsub(/[,)]/,"",ssim); gsub(/[,)]/,"",p); gsub(/[,)]/,"",r); gsub(/,/,"",miou)
            if (miou=="") miou="nan"; print psnr "," ssim "," f "," p "," r "," miou}' "$1"
}

echo "row,seed,psnr,ssim,fscore,precision,recall,miou" > "$output/results.csv"
for seed in $seeds; do
  scene="$output/scene_$seed"
  [ -d "$scene" ] || "$program" synth "$scene" --room "$room" --room-seed 1 --teacher-seed "$seed" -q > "$output/acceptance_$seed.txt"
  for row in "${rows[@]}"; do
    name=${row%%|*}
    read -r -a options <<< "${row#*|}"
    run="$output/${name// /_}_$seed"
    if [ ! -f "$run/summary.txt" ]; then
      "$program" run "$scene" -o "$run" -n "$iterations" --seed "$seed" --resume --no-refine -q "${options[@]}" > "$run.txt"
      mv "$run.txt" "$run/summary.txt"
    fi
    echo "$name,$seed,$(figures "$run/summary.txt")" >> "$output/results.csv"
  done
  yardstick="$output/prior_tsdf_$seed"
  if [ ! -f "$yardstick.txt" ]; then
    "$program" mesh "$output/preset_default_$seed" --from-prior -o "$yardstick.ply" -q > /dev/null
    "$program" eval "$output/preset_default_$seed" --mesh "$yardstick.ply" -q > "$yardstick.partial"
    mv "$yardstick.partial" "$yardstick.txt"
  fi
  echo "TSDF of the prior depth,$seed,$(figures "$yardstick.txt" | awk -F, '{print "nan,nan," $3 "," $4 "," $5 ",nan"}')" >> "$output/results.csv"
done

awk -F, 'NR > 1 {
    if (!($1 in seen)) {seen[$1] = 1; order[++rows] = $1}
    for (k = 3; k <= 8; ++k) if ($k != "nan" && $k != "–") {n[$1,k]++; s[$1,k] += $k; q[$1,k] += $k * $k}
  }
  function cell(name, k, digits,   m, v) {
    if (!n[name,k]) return "–"
    m = s[name,k] / n[name,k]; v = n[name,k] > 1 ? (q[name,k] - n[name,k] * m * m) / (n[name,k] - 1) : 0
    return sprintf("%." digits "f ± %." digits "f", m, sqrt(v > 0 ? v : 0))
  }
  END {
    print "| | PSNR (dB) | SSIM | F at 5 cm | precision | recall | mIoU |"
    print "|---|---|---|---|---|---|---|"
    for (i = 1; i <= rows; ++i)
      print "| " order[i] " | " cell(order[i],3,2) " | " cell(order[i],4,3) " | " cell(order[i],5,3) " | " cell(order[i],6,3) " | " cell(order[i],7,3) " | " cell(order[i],8,3) " |"
  }' "$output/results.csv"
