// From four layers of patch tokens to one map of features. Common part of the dense heads of VGGT and DA3, with the
// tensor names of both.
#pragma once

#include <string>
#include <vector>

#include "nn/dpt_parts.h"
#include "nn/ops/norm.h"

namespace aligngs::nn {

/// Four maps of the patch grid become four levels of a pyramid: 4, 2, 1 and 1/2 times the grid.
class DptPyramid {
 public:
  struct Options {
    bool normed_and_placed = false;  ///< LayerNorm before, uv embedding within
  };
  /// norm, projects.j, resize_layers.j, scratch.layer{j + 1}_rn below `weights`.
  DptPyramid(const Compute& compute, const Weights& weights, const Options& options);

  int64_t inputs() const { return inputs_; }      ///< channels of a token
  int64_t features() const { return features_; }  ///< channels of every level

  /// `layers`: finest level first, all of one grid; aspect: width / height of the image. Error{kFailed} when there are
  /// not four.
  std::vector<FeatureMap> operator()(Compute& compute, std::vector<FeatureMap> layers, double aspect) const;

 private:
  Options options_;
  int64_t inputs_ = 0, features_ = 0;
  LayerNorm norm_;
  std::vector<DptLevel> levels_;
};

/// The levels joined from the coarsest to the finest, and doubled once more: 8 times the grid.
class DptFusion {
 public:
  struct Options {
    std::string suffix;           ///< of the names: scratch.refinenet1{suffix}
    bool rectified_skip = false;  ///< as ResidualUnit has it: VGGT's skips carry relu(x), DA3's x
  };
  DptFusion(const Compute& compute, const Weights& weights, const Options& options);

  FeatureMap operator()(Compute& compute, const std::vector<FeatureMap>& levels) const;

 private:
  struct Step {
    ResidualUnit unit1, unit2;
    Linear out;
  };
  std::vector<Step> steps_;  ///< finest first
};

/// x += 0.1 uv embedding of its own grid.
void add_uv_embedding(Compute& compute, FeatureMap& x, double aspect);

}  // namespace aligngs::nn
