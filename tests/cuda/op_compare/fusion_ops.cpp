#include <utility>

#include "compare_ops.h"
#include "mesh/cuda/tsdf_fusion.h"
#include "mesh/testing/analytic_scenes.h"
#include "mesh/tsdf_volume.h"

namespace aligngs::op_compare {

/// Views of a ball, fused by both. The field is the same to the last bit, so its numbers are compared as such.
void compare_fusion(int device, OpTable& table) {
  ThreadPool pool(1);
  const std::vector<FusionFrame> frames = test::ball_views(0.5);
  const ImageF weight(frames[0].depth.width, frames[0].depth.height, 1, 1.0f);
  std::vector<TsdfView> views;
  for (const FusionFrame& f : frames) views.push_back({&f.camera, &f.depth, nullptr, &weight, nullptr, false});
  TsdfOptions options;
  options.voxel = 0.06;
  options.truncation = 0.18;
  const auto fused = [&](TsdfDevice* on) {
    TsdfVolume volume(options);
    for (const TsdfView& v : views) volume.reserve(v, pool);
    volume.allocate();
    if (on != nullptr) {
      volume.integrate(views, *on);
    } else {
      for (const TsdfView& v : views) volume.integrate(v, pool);
    }
    std::vector<float> distance, weights;
    for (size_t b = 0; b < volume.blocks(); ++b) {
      for (int v = 0; v < kBlockVoxels; ++v) {
        distance.push_back(volume.voxels(b)[v].tsdf);
        weights.push_back(volume.voxels(b)[v].weight);
      }
    }
    return std::pair{distance, weights};
  };
  const auto on_device = make_cuda_tsdf_device(device);
  const auto [distance, weights] = fused(on_device.get());
  const auto [want_distance, want_weights] = fused(nullptr);
  table.compare("fusion", "distance", distance, want_distance, exact());
  table.compare("fusion", "weight", weights, want_weights, exact());
}

}  // namespace aligngs::op_compare
