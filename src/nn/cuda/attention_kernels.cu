#include "nn/cuda/attention_kernels.h"

#include "device/launch.h"
#include "nn/cuda/attention_kernels.cuh"

namespace aligngs::cuda {
namespace {

unsigned blocks_of(const nn::AttentionShape& shape, int64_t queries_per_block) {
  return static_cast<unsigned>(shape.sequences * shape.heads *
                               ((shape.queries + queries_per_block - 1) / queries_per_block));
}

template <int kDimTiles>
void launch_flash(const DeviceContext& context, const AttentionSpans& spans) {
  launch(context, "flash", flash_kernel<kDimTiles>,
         {dim3(blocks_of(spans.shape, kAttentionQueries)), dim3(kAttentionThreads)}, spans);
}

}  // namespace

void attention_bf16(const DeviceContext& context, const AttentionSpans& spans) {
  const int64_t dim = spans.shape.head_dim;
  if (dim <= 16) return launch_flash<1>(context, spans);
  if (dim <= 32) return launch_flash<2>(context, spans);
  if (dim <= 64) return launch_flash<4>(context, spans);
  launch_flash<8>(context, spans);
}

void attention_float(const DeviceContext& context, const AttentionSpans& spans) {
  launch(context, "attend_float", attend_float_kernel,
         {dim3(blocks_of(spans.shape, kAttentionWarps)), dim3(kAttentionThreads)}, spans);
}

}  // namespace aligngs::cuda
