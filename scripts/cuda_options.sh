#!/usr/bin/env bash
# Prints CMake's options for CUDA on this machine, one per line: ON if nvcc works, so that CUDA cannot be left out
# silently, else AUTO. An nvcc that builds no program (a script without its toolkit, a host compiler
# that it refuses, a version before 12) counts as none.
set -euo pipefail
nvcc=$(PATH="${CUDAToolkit_ROOT:+$CUDAToolkit_ROOT/bin:}${CUDA_PATH:+$CUDA_PATH/bin:}$PATH:/usr/local/cuda/bin" command -v nvcc || true)
if [ -n "$nvcc" ]; then
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  cat >"$folder/probe.cu" <<'PROBE'
#include <cub/version.cuh>
#include <cuda_bf16.h>
__global__ void kernel() {}
int main() { kernel<<<1, 1>>>(); }
PROBE
  if "$nvcc" -std=c++20 -arch=sm_90 -cudart static -o "$folder/probe" "$folder/probe.cu" >"$folder/log" 2>&1; then
    printf '%s\n' -DALIGNGS_WITH_CUDA=ON "-DALIGNGS_NVCC=$nvcc"
    exit 0
  fi
  echo "cuda_options.sh: $nvcc builds no program and counts as none: $(head -n 1 "$folder/log")" >&2
fi
echo -DALIGNGS_WITH_CUDA=AUTO
