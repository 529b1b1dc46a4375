// The dense heads of Depth Anything 3: depth with confidence and rays of the any-view networks, depth and sky of the
// metric one.
#pragma once

#include <array>
#include <vector>

#include "nn/dpt_pyramid.h"

namespace aligngs::nn {

class Da3DualHead {
 public:
  /// `weights`: the tensors below "head.". The ray branch is loaded when its tensors are there.
  Da3DualHead(const Compute& compute, const Weights& weights);

  int64_t inputs() const { return pyramid_.inputs(); }
  bool has_rays() const { return !ray_output_.empty(); }

  struct Output {
    FeatureMap depth;  ///< [H, W, 2]: depth along the axis in units of the translations, confidence >= 1
    FeatureMap rays;   ///< [8 h, 8 w, 7]: direction (not unit), origin, confidence >= 1; empty unless wanted
  };
  /// maps: of one view, finest level first; height, width: of the image.
  Output operator()(Compute& compute, std::vector<FeatureMap> maps, int64_t height, int64_t width, bool rays) const;

 private:
  FeatureMap rays_of(Compute& compute, const std::vector<FeatureMap>& levels, double aspect) const;

  DptPyramid pyramid_;
  DptFusion fusion_;
  Convolution output1_, output2_;
  Linear output3_;
  std::vector<DptFusion> ray_fusion_;    ///< one, or none without the branch
  std::vector<Convolution> ray_widths_;  ///< with nothing between them
  Convolution ray_hidden_;
  LayerNorm ray_norm_;
  Linear ray_output_;
};

class Da3SkyHead {
 public:
  /// `weights`: the tensors below "head.".
  Da3SkyHead(const Compute& compute, const Weights& weights);

  int64_t inputs() const { return pyramid_.inputs(); }
  /// [H, W, 2]: depth, and a value of about 0 on the ground and 1 in the sky (no probability).
  FeatureMap operator()(Compute& compute, std::vector<FeatureMap> maps, int64_t height, int64_t width) const;

 private:
  DptPyramid pyramid_;
  DptFusion fusion_;
  Convolution output1_;
  struct Branch {
    Convolution hidden;
    Linear output;
  };
  std::array<Branch, 2> branches_;  ///< depth, sky
};

}  // namespace aligngs::nn
