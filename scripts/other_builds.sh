#!/usr/bin/env bash
# Tests that another build is for, and nothing else: each takes minutes.
# Usage: scripts/other_builds.sh [PRESET...]     default: scalar-only tsan clang
#   scalar-only  no vector instruction: the vectorised modules are right without them, as on a processor of another kind
#   tsan         thread sanitizer: the pool, the engine and its engines' scratch memory, downloads
#   clang        clang 14: a second reading of the sources by a compiler, and its order of floating-point operations
set -euo pipefail
cd "$(dirname "$0")/.."
presets=("$@")
[ ${#presets[@]} -gt 0 ] || presets=(scalar-only tsan clang)
for preset in "${presets[@]}"; do
  filter='*'
  case "$preset" in
    scalar-only) programs=(core_tests engine_tests nn_tests) ;;
    # Derivatives by finite differences and measurements of the machine run on one thread.
    tsan) programs=(core_tests engine_tests); filter='-Gradients/*:Losses/*:ShapeTerms*:Through*:InstructionLimit*:StepBenchmark*' ;;
    clang) programs=(core_tests engine_tests io_tests); scripts/setup.sh --clang ;;
    -h|--help) sed -n '2,6p' "$0" | cut -c3-; exit 0 ;;
    *) echo "other_builds.sh: unknown preset $preset" >&2; exit 2 ;;
  esac
  begin=$SECONDS
  targets=()
  for program in "${programs[@]}"; do targets+=(--target "$program"); done
  scripts/build.sh "build/$preset" "${targets[@]}" --preset "$preset" -DALIGNGS_BUILD_BENCHMARKS=OFF -DALIGNGS_UNITY_BUILD=ON \
    -DALIGNGS_WITH_CUDA=OFF -DALIGNGS_BUILD_GPU_TESTS=OFF
  for program in "${programs[@]}"; do
    "build/$preset/tests/$program" --gtest_brief=1 --gtest_filter="$filter"
  done
  echo "other_builds: $preset $((SECONDS - begin)) s"
done
