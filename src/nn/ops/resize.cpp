#include "nn/ops/resize.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "nn/network_device.h"

namespace aligngs::nn {
namespace {

double cubic(double t, double a) {
  t = std::abs(t);
  if (t <= 1) return ((a + 2) * t - (a + 3)) * t * t + 1;
  if (t < 2) return ((a * t - 5 * a) * t + 8 * a) * t - 4 * a;
  return 0;
}

ResampleAxis axis_of(int64_t inputs, int64_t outputs) {
  if (inputs <= 0 || outputs <= 0) throw Error({ErrorKind::kFailed, "resizing to or from nothing", {}, "size", ""});
  ResampleAxis axis;
  axis.inputs = inputs;
  axis.first.push_back(0);
  return axis;
}

void add_tap(ResampleAxis& axis, int64_t index, double weight) {
  axis.index.push_back(index);
  axis.weight.push_back(static_cast<float>(weight));
}
void end_output(ResampleAxis& axis) { axis.first.push_back(int64_t(axis.index.size())); }

}  // namespace

ResampleAxis bilinear_axis(int64_t inputs, int64_t outputs, bool align_corners) {
  ResampleAxis axis = axis_of(inputs, outputs);
  for (int64_t i = 0; i < outputs; ++i) {
    double source;
    if (align_corners) {
      source = outputs > 1 ? double(i) * double(inputs - 1) / double(outputs - 1) : 0;
    } else {
      source = std::max((double(i) + 0.5) * double(inputs) / double(outputs) - 0.5, 0.0);
    }
    const int64_t low = std::min(int64_t(source), inputs - 1), high = std::min(low + 1, inputs - 1);
    const double f = source - double(low);
    add_tap(axis, low, 1 - f);
    add_tap(axis, high, f);
    end_output(axis);
  }
  return axis;
}

ResampleAxis bicubic_axis(int64_t inputs, int64_t outputs, double step) {
  ResampleAxis axis = axis_of(inputs, outputs);
  for (int64_t i = 0; i < outputs; ++i) {
    const double source = (double(i) + 0.5) * step - 0.5;
    const auto floor = static_cast<int64_t>(std::floor(source));
    for (int64_t k = floor - 1; k <= floor + 2; ++k) {
      constexpr double kA = -0.75;
      add_tap(axis, std::clamp<int64_t>(k, 0, inputs - 1), cubic(source - double(k), kA));
    }
    end_output(axis);
  }
  return axis;
}

ResampleAxis antialiased_bicubic_axis(int64_t inputs, int64_t outputs, double step) {
  ResampleAxis axis = axis_of(inputs, outputs);
  const double scale = step > 0 ? step : double(inputs) / double(outputs);
  const double widening = std::max(scale, 1.0);
  const double support = 2 * widening;
  for (int64_t i = 0; i < outputs; ++i) {
    const double centre = scale * (double(i) + 0.5);
    const int64_t low = std::max<int64_t>(int64_t(centre - support + 0.5), 0);
    const int64_t high = std::min<int64_t>(int64_t(centre + support + 0.5), inputs);
    constexpr double kA = -0.5;
    double total = 0;
    for (int64_t k = low; k < high; ++k) total += cubic((double(k) + 0.5 - centre) / widening, kA);
    for (int64_t k = low; k < high; ++k) add_tap(axis, k, cubic((double(k) + 0.5 - centre) / widening, kA) / total);
    end_output(axis);
  }
  return axis;
}

ResampleAxis area_axis(int64_t inputs, int64_t outputs) {
  ResampleAxis axis = axis_of(inputs, outputs);
  for (int64_t i = 0; i < outputs; ++i) {
    const int64_t low = i * inputs / outputs, high = ((i + 1) * inputs + outputs - 1) / outputs;
    for (int64_t k = low; k < high; ++k) add_tap(axis, k, 1.0 / double(high - low));
    end_output(axis);
  }
  return axis;
}

ResampleAxis part_of_axis(const ResampleAxis& axis, const std::vector<int64_t>& outputs) {
  ResampleAxis part;
  part.inputs = axis.inputs;
  part.first.push_back(0);
  for (const int64_t i : outputs) {
    const int64_t from = axis.first[size_t(i)], to = axis.first[size_t(i) + 1];
    part.index.insert(part.index.end(), axis.index.begin() + from, axis.index.begin() + to);
    part.weight.insert(part.weight.end(), axis.weight.begin() + from, axis.weight.begin() + to);
    end_output(part);
  }
  return part;
}

ResampleAxis part_of_axis(const ResampleAxis& axis, int64_t begin, int64_t count) {
  std::vector<int64_t> outputs(static_cast<size_t>(count));
  std::iota(outputs.begin(), outputs.end(), begin);
  return part_of_axis(axis, outputs);
}

UsedInputs used_inputs(const ResampleAxis& axis) {
  UsedInputs used{axis.index, axis};
  std::sort(used.inputs.begin(), used.inputs.end());
  used.inputs.erase(std::unique(used.inputs.begin(), used.inputs.end()), used.inputs.end());
  for (int64_t& index : used.axis.index)
    index = std::lower_bound(used.inputs.begin(), used.inputs.end(), index) - used.inputs.begin();
  used.axis.inputs = int64_t(used.inputs.size());
  return used;
}

FeatureMap resample(Compute& compute, const FeatureMap& x, const ResampleAxis& vertical,
                    const ResampleAxis& horizontal) {
  FeatureMap y(vertical.outputs(), horizontal.outputs(), x.channels);
  if (NetworkDevice* const device = compute.device()) {
    device->resample(x.data.on(*device), x.height, x.width, x.channels, vertical, horizontal, y.data.write_on(*device));
    return y;
  }
  const int64_t line = x.width * x.channels;
  compute.for_rows(y.height, 1, [&](int64_t row, int64_t, Scratch& scratch) {
    float* mixed = scratch.floats(size_t(line));  // the input rows, mixed for this output row
    std::fill_n(mixed, line, 0.0f);
    for (int64_t t = vertical.first[size_t(row)]; t < vertical.first[size_t(row) + 1]; ++t) {
      const float w = vertical.weight[size_t(t)];
      const float* from = x.at(vertical.index[size_t(t)], 0);
      for (int64_t i = 0; i < line; ++i) mixed[i] += w * from[i];
    }
    for (int64_t column = 0; column < y.width; ++column) {
      float* out = y.at(row, column);
      for (int64_t t = horizontal.first[size_t(column)]; t < horizontal.first[size_t(column) + 1]; ++t) {
        const float w = horizontal.weight[size_t(t)];
        const float* from = mixed + horizontal.index[size_t(t)] * x.channels;
        for (int64_t c = 0; c < x.channels; ++c) out[c] += w * from[c];
      }
    }
  });
  return y;
}

FeatureMap resize_bilinear_map(Compute& compute, const FeatureMap& x, int64_t height, int64_t width,
                               bool align_corners) {
  return resample(compute, x, bilinear_axis(x.height, height, align_corners),
                  bilinear_axis(x.width, width, align_corners));
}

}  // namespace aligngs::nn
