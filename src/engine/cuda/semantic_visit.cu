#include "engine/cuda/semantic_visit.h"

#include <type_traits>

#include "core/error.h"
#include "device/constants.h"
#include "engine/cuda/semantic_visit.cuh"
#include "engine/cuda/sum_columns.cuh"

namespace aligngs::cuda {
namespace {

/// Channels / 32 of a dense visit at most: P of more would not fit into any device's shared memory.
constexpr int kDenseGroups = 5;

/// One block of threads per tile visits the tile's blocks of pixels in turn. There are four of 8 x 8, or one of 16 x 16
/// (VisitForm). dS and the moments of a Gaussian are collected over these blocks in its slot, which only this block of
/// threads writes. The first of its blocks sets them, later ones add. So every sum has a fixed order.
template <class Form, int kGroups>
__global__ void __launch_bounds__(Form::kThreads)
    semantic_visit_kernel(SemanticVisitInputs in, SemanticVisitOutputs out, int padded) {
  constexpr int kTileWarps = kTilePixels / kWarp;
  const VisitLayout<Form> layout{padded};
  VisitShared<Form>& s = *dynamic_shared<VisitShared<Form>>();
  const int thread = static_cast<int>(threadIdx.x), tile = static_cast<int>(blockIdx.x);
  Visit<Form> v{in,
                out,
                layout,
                s,
                dynamic_shared<float>(layout.blended_at()),
                dynamic_shared<Bf16>(layout.rows_at()),
                dynamic_shared<float>(layout.rows_at()),
                tile,
                tile % in.view.tiles_x,
                tile / in.view.tiles_x,
                thread,
                thread / kWarp,
                thread % kWarp,
                in.lists.tile_begin[tile],
                0,
                0};

  // Thread i looks at pixel i of the tile: how far its list goes, and which blocks have a teacher.
  const int x = v.tile_x * kTileSize + tile_pixel_x(thread), y = v.tile_y * kTileSize + tile_pixel_y(thread);
  const bool inside = thread < kTilePixels && x < in.view.width && y < in.view.height;
  const bool valid = inside && in.sample.takes(x, y) && in.teacher.top_class[size_t(y) * in.view.width + x] != kNoLabel;
  const uint32_t last = inside ? in.record.last[size_t(tile) * kTilePixels + thread] : 0;
  const uint32_t warp_last = __reduce_max_sync(kFullWarp, last);
  const unsigned votes = __ballot_sync(kFullWarp, valid);
  if (v.lane == 0) {
    s.last[v.warp] = warp_last;
    s.teacher[v.warp] = votes;
  }
  __syncthreads();
  for (int w = 0; w < kTileWarps; ++w) {
    v.end = s.last[w] > v.end ? s.last[w] : v.end;
    v.teacher |= s.teacher[w] != 0 ? 1u << (w * kWarp / Form::kPixels) : 0u;
  }
  __syncthreads();

  double soft = 0, hard = 0;
  for (int b = 0; b < Form::kBlocks; ++b) {
    if (((v.teacher >> b) & 1u) == 0) continue;
    const int i = b * Form::kPixels + v.pixel();
    const bool pixel_inside = v.tile_x * kTileSize + tile_pixel_x(i) < in.view.width &&
                              v.tile_y * kTileSize + tile_pixel_y(i) < in.view.height;
    const uint32_t pixel_last = pixel_inside ? in.record.last[size_t(tile) * kTilePixels + i] : 0;
    const float t = blend_rows<Form, kGroups>(v, b, pixel_last);
    block_loss<Form, kGroups>(v, b, soft, hard);
    block_gradients(v, b, pixel_last, t);
    __syncthreads();
  }
  if (v.lane == 0) {
    s.terms[v.warp][kSoftTerm] = soft;
    s.terms[v.warp][kHardTerm] = hard;
  }
  __syncthreads();
  if (thread < kSemanticTerms) {
    double sum = 0;
    for (int w = 0; w < Form::kWarps; ++w) sum += s.terms[w][thread];
    out.tile_terms[kSemanticTerms * size_t(tile) + thread] = sum;
  }
}

using VisitKernel = void (*)(SemanticVisitInputs, SemanticVisitOutputs, int);

template <class Form>
VisitKernel kernel_for(int padded) {
  const int groups = (padded + kWarp - 1) / kWarp;
  if (groups <= 1) return semantic_visit_kernel<Form, 1>;
  if (groups <= 2) return semantic_visit_kernel<Form, 2>;
  if (groups <= 3) return semantic_visit_kernel<Form, 3>;
  if constexpr (std::is_same_v<Form, DenseVisit>) {
    return semantic_visit_kernel<Form, kDenseGroups>;
  } else {
    if (groups <= 5) return semantic_visit_kernel<Form, 5>;
    return semantic_visit_kernel<Form, 8>;
  }
}

template <class Form>
void launch_visit(const DeviceContext& context, const SemanticVisitInputs& in, const SemanticVisitOutputs& out,
                  unsigned tiles) {
  const int padded = padded_channels(in.teacher.channels);
  launch(context, "semantic_visit", kernel_for<Form>(padded),
         {dim3(tiles), dim3(Form::kThreads), VisitLayout<Form>{padded}.bytes()}, in, out, padded);
}

VisitDevice device_of(const DeviceContext& context) {
  const calls::DeviceFacts& facts = context.facts();
  return {facts.major, facts.minor, facts.shared_memory_per_block};
}

}  // namespace

SemanticVisitMethod semantic_visit_method(SemanticVisitMethod wanted, const VisitDevice& device, int channels) {
  const bool hbm = (device.compute_major == 8 && device.compute_minor == 0) || device.compute_major == 9 ||
                   device.compute_major == 10;
  if (wanted == SemanticVisitMethod::kAutomatic) {
    wanted = hbm ? SemanticVisitMethod::kDense : SemanticVisitMethod::kCompacted;
  }
  const int padded = padded_channels(channels);
  const bool fits = padded <= kDenseGroups * kWarp && VisitLayout<DenseVisit>{padded}.bytes() <= device.shared_bytes;
  return fits ? wanted : SemanticVisitMethod::kCompacted;
}

void check_semantic_channels(const DeviceContext& context, int channels) {
  const VisitLayout<CompactedVisit> layout{padded_channels(channels)};
  if (channels <= kMaxSemanticChannels && layout.bytes() <= context.facts().shared_memory_per_block) return;
  throw_resources({}, std::to_string(channels) + " semantic channels are more than this device holds at a time",
                  "train fewer classes: keep the limit on active classes on, or train on the CPU (--device cpu)");
}

void semantic_visit(const DeviceContext& context, const SemanticVisitInputs& in, const SemanticVisitOutputs& out) {
  fill_zero(context, out.seen);
  const unsigned tiles = static_cast<unsigned>(in.view.tiles_x) * static_cast<unsigned>(in.view.tiles_y);
  if (semantic_visit_method(in.method, device_of(context), in.teacher.channels) == SemanticVisitMethod::kDense) {
    launch_visit<DenseVisit>(context, in, out, tiles);
  } else {
    launch_visit<CompactedVisit>(context, in, out, tiles);
  }
  sum_columns<kSemanticTerms>(context, out.tile_terms.part(0, kSemanticTerms * size_t(tiles)),
                              static_cast<double>(in.sample.scale()) / static_cast<double>(in.teacher.valid),
                              out.terms);
}

}  // namespace aligngs::cuda
