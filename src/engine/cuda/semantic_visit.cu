#include "engine/cuda/semantic_visit.h"

#include "core/error.h"
#include "engine/cuda/constants.h"
#include "engine/cuda/semantic_visit.cuh"
#include "engine/cuda/sum_columns.cuh"

namespace aligngs::cuda {
namespace {

using VisitKernel = void (*)(SemanticVisitInputs, SemanticVisitOutputs, int);

VisitKernel kernel_for(int padded) {
  const int groups = (padded + kWarp - 1) / kWarp;
  if (groups <= 1) return semantic_visit_kernel<1>;
  if (groups <= 2) return semantic_visit_kernel<2>;
  if (groups <= 3) return semantic_visit_kernel<3>;
  if (groups <= 5) return semantic_visit_kernel<5>;
  return semantic_visit_kernel<8>;
}

/// Bytes of shared memory that a block may ask for.
size_t shared_memory_of(const DeviceContext& context) {
#ifdef ALIGNGS_CUDA_EMULATED
  (void)context;
  return size_t(227) * 1024;  // of compute capability 9.0
#else
  int bytes = 0;
  check_cuda(cudaDeviceGetAttribute(&bytes, cudaDevAttrMaxSharedMemoryPerBlockOptin, context.device()),
             "shared memory of the device");
  return static_cast<size_t>(bytes);
#endif
}

}  // namespace

void check_semantic_channels(const DeviceContext& context, int channels) {
  const VisitLayout layout{padded_channels(channels)};
  if (channels <= kMaxSemanticChannels && layout.bytes() <= shared_memory_of(context)) return;
  throw_resources({}, std::to_string(channels) + " semantic channels are more than this device holds at a time",
                  "train fewer classes: keep the limit on active classes on, or train on the CPU (--device cpu)");
}

void semantic_visit(const DeviceContext& context, const SemanticVisitInputs& in, const SemanticVisitOutputs& out) {
  const int padded = padded_channels(in.teacher.channels);
  const VisitLayout layout{padded};
  fill_zero(context, out.seen);
  const unsigned tiles = static_cast<unsigned>(in.view.tiles_x) * static_cast<unsigned>(in.view.tiles_y);
  launch(context, "semantic_visit", kernel_for(padded), {dim3(tiles), dim3(kVisitThreads), layout.bytes()}, in, out,
         padded);
  sum_columns<2>(context, out.tile_terms.part(0, 2 * size_t(tiles)), static_cast<double>(in.sample.scale()) / static_cast<double>(in.teacher.valid),
                 out.terms);
}

}  // namespace aligngs::cuda
