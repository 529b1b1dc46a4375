#!/usr/bin/env bash
# Tests that another build is for, and nothing else: each takes minutes.
# Usage: scripts/other_builds.sh [BUILD...]     default: scalar-only tsan clang
#   scalar-only  no vector instruction: the vectorised modules are right without them, as on a processor of another kind
#   tsan         thread sanitizer: the pool of threads, and the engine that runs on it
#   clang        clang 14: another compiler's warnings, and its order of floating-point operations
#   scalar-tsan  the first two at once, with clang, for .ci/run, which has little time
set -euo pipefail
cd "$(dirname "$0")/.."
# The thread sanitizer of GCC 12 ends at once where the system places memory in too many random ways.
fixed_places=()
setarch "$(uname -m)" -R true 2>/dev/null && fixed_places=(setarch "$(uname -m)" -R)
builds=("$@")
[ ${#builds[@]} -gt 0 ] || builds=(scalar-only tsan clang)
# Derivatives by finite differences and measurements of the machine run on one thread. The others do what shorter ones do.
one_thread='Gradients/*:Losses/*:ShapeTerms*:Through*:InstructionLimit*:StepBenchmark*:BenchmarkRoom*'
long='*.TrainingAgreesWithAllClasses:*.LossFallsOverSomeSteps:*.WindowOfTheBenchmarkRoom/*:*.TenThousand*'
for build in "${builds[@]}"; do
  filter='*' preset=$build settings=()
  case "$build" in
    scalar-only) programs=(core_tests engine_tests nn_tests) ;;
    tsan) programs=(core_tests engine_tests); filter="-$one_thread:$long" ;;
    scalar-tsan)
      programs=(core_tests engine_tests); filter="-$one_thread:$long"; preset=tsan; scripts/setup.sh --clang
      # clang compiles sanitized sources in less than half of GCC's time.
      settings=(-DALIGNGS_SCALAR_ONLY=ON -DCMAKE_CXX_COMPILER=clang++-14) ;;
    clang) programs=(core_tests engine_tests io_tests); scripts/setup.sh --clang ;;
    -h|--help) sed -n '2,7p' "$0" | cut -c3-; exit 0 ;;
    *) echo "other_builds.sh: unknown build $build" >&2; exit 2 ;;
  esac
  begin=$SECONDS
  targets=()
  for program in "${programs[@]}"; do targets+=(--target "$program"); done
  scripts/build.sh "build/$build" "${targets[@]}" --preset "$preset" "${settings[@]}" -DALIGNGS_BUILD_BENCHMARKS=OFF -DALIGNGS_UNITY_BUILD=ON \
    -DALIGNGS_WITH_CUDA=OFF -DALIGNGS_BUILD_GPU_TESTS=OFF
  for program in "${programs[@]}"; do
    "${fixed_places[@]}" "build/$build/tests/$program" --gtest_brief=1 --gtest_filter="$filter"
  done
  echo "other_builds: $build $((SECONDS - begin)) s"
done
