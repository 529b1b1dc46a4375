// Resizing of feature maps and position embeddings, by the rules of PyTorch's interpolate.
#pragma once

#include <cstdint>
#include <vector>

#include "nn/compute.h"
#include "nn/tensor.h"

namespace aligngs::nn {

/// One axis of a separable resampling: output i is the sum of weight * input over its taps.
struct ResampleAxis {
  int64_t inputs = 0;
  std::vector<int64_t> first;  ///< of output i in the lists below; one more than outputs
  std::vector<int64_t> index;  ///< inputs
  std::vector<float> weight;
  int64_t outputs() const { return int64_t(first.size()) - 1; }
};

/// align_corners: the outermost centres coincide; otherwise src = max((i + 0.5) in / out - 0.5, 0).
ResampleAxis bilinear_axis(int64_t inputs, int64_t outputs, bool align_corners);
/// Cubic with a = -0.75, no antialiasing, edges repeated; src = (i + 0.5) step - 0.5, where step is
/// in / out, or 1 / scale_factor when PyTorch is called with a scale.
ResampleAxis bicubic_axis(int64_t inputs, int64_t outputs, double step);
/// Cubic with a = -0.5, widened when shrinking, weights renormalised at the edges (antialias=True).
/// `step` as above; 0: in / out.
ResampleAxis antialiased_bicubic_axis(int64_t inputs, int64_t outputs, double step = 0);

/// Means over the inputs that output i covers in part or whole (mode area).
ResampleAxis area_axis(int64_t inputs, int64_t outputs);

/// Outputs [begin, begin + count) of an axis.
ResampleAxis part_of_axis(const ResampleAxis& axis, int64_t begin, int64_t count);
/// These outputs of an axis, in this order.
ResampleAxis part_of_axis(const ResampleAxis& axis, const std::vector<int64_t>& outputs);

/// The inputs that an axis weighs, sorted, each once; and the axis with indices into that list.
struct UsedInputs {
  std::vector<int64_t> inputs;
  ResampleAxis axis;
};
UsedInputs used_inputs(const ResampleAxis& axis);

FeatureMap resample(Compute& compute, const FeatureMap& x, const ResampleAxis& vertical,
                    const ResampleAxis& horizontal);
FeatureMap resize_bilinear_map(Compute& compute, const FeatureMap& x, int64_t height, int64_t width,
                               bool align_corners);

}  // namespace aligngs::nn
