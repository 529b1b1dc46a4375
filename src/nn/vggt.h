// VGGT: cameras, depth and points of all photographs of a scene in one pass.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "nn/vggt_heads.h"

namespace aligngs::nn {

/// Settings that the weights do not hold; the defaults are those of VGGT-1B.
struct VggtOptions {
  int64_t heads = 0;         ///< of the aggregator; 0: channels / 64
  int64_t camera_heads = 0;  ///< 0: channels / 128
  std::vector<int> layers;   ///< of the dense heads; empty: 4, 11, 17, 23 (of 24, or in proportion)
};

struct VggtRequest {
  bool depth = true;
  bool points = false;  ///< the point head; unprojected depth is the better cloud
};

struct VggtFrame {
  VggtCamera camera;
  FeatureMap depth;   ///< [H, W, 2]: depth along the axis in units of the scene, confidence >= 1
  FeatureMap points;  ///< [H, W, 4]: x, y, z in the world, confidence >= 1
};

class Vggt {
 public:
  /// Heads whose weights are absent stay unused (the tracker's are never read).
  Vggt(Compute& compute, const Weights& weights, const VggtOptions& options = {});

  /// Images in [0, 1], one size, sides multiples of 14. Each frame is handed to `take` as soon as
  /// it is done, in order: dense maps of all frames never exist together.
  void operator()(Compute& compute, std::vector<FeatureMap> images, const VggtRequest& request,
                  const std::function<void(int64_t, VggtFrame)>& take) const;

  const VggtAggregator& aggregator() const { return *aggregator_; }
  const VggtCameraHead& camera_head() const { return *camera_head_; }
  const VggtDenseHead& depth_head() const { return *depth_head_; }
  const VggtDenseHead& point_head() const { return *point_head_; }
  const std::vector<int>& layers() const { return layers_; }
  /// The camera head works in float32 whatever the precision, as the publisher's does.
  Compute& exact() const { return *exact_; }
  /// Rows of the last layer that the camera head reads.
  static Matrix camera_tokens(const AggregatedTokens& tokens);

 private:
  std::unique_ptr<Compute> exact_;
  std::optional<VggtAggregator> aggregator_;
  std::optional<VggtCameraHead> camera_head_;
  std::optional<VggtDenseHead> depth_head_, point_head_;
  std::vector<int> layers_;
};

/// Points of a depth map in the world: pixel centres count as integers, as in training. [H, W, 3].
FeatureMap unproject_depth(const FeatureMap& depth, const VggtCamera& camera);

}  // namespace aligngs::nn
