#include "nn/da3/metric_scale.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "nn/da3/metric.h"

namespace aligngs::nn {
namespace {

constexpr size_t kFewest = 10;  // ground pixels

bool is_ground(const FeatureMap& metric, int64_t pixel) {
  return metric.data[size_t(2 * pixel + 1)] < kDa3SkyThreshold;
}

/// Channel `channel` of the frames' depth maps where the ground is.
std::vector<float> on_ground(const std::vector<Da3Frame>& frames, const std::vector<FeatureMap>& metric,
                             size_t channel) {
  std::vector<float> values;
  for (size_t s = 0; s < frames.size(); ++s) {
    for (int64_t i = 0; i < metric[s].places(); ++i) {
      if (is_ground(metric[s], i)) values.push_back(frames[s].depth.data[size_t(2 * i) + channel]);
    }
  }
  return values;
}

void check_sizes(const std::vector<Da3Frame>& frames, const std::vector<FeatureMap>& metric) {
  bool same = frames.size() == metric.size();
  for (size_t s = 0; same && s < frames.size(); ++s) {
    same = frames[s].depth.height == metric[s].height && frames[s].depth.width == metric[s].width &&
           frames[s].depth.channels == 2 && metric[s].channels == 2;
  }
  if (!same) {
    throw_bad_input({}, "depth", "the two networks' maps are not of the same images", "run both on the same images");
  }
}

}  // namespace

double quantile_of(std::vector<float> values, double q) {
  const double at = q * double(values.size() - 1);
  const auto low = size_t(std::floor(at));
  const auto middle = values.begin() + std::ptrdiff_t(low);
  std::nth_element(values.begin(), middle, values.end());
  const double below = double(*middle);
  if (low + 1 >= values.size()) return below;
  const double above = double(*std::min_element(middle + 1, values.end()));
  return below + (at - double(low)) * (above - below);
}

MetricScale da3_metric_scale(const std::vector<Da3Frame>& frames, const std::vector<FeatureMap>& metric) {
  check_sizes(frames, metric);
  const std::vector<float> confidences = on_ground(frames, metric, 1);
  if (confidences.size() <= kFewest)
    throw_bad_input({}, "sky", "the metric network sees hardly any ground", "use photos of a room");
  const double median = quantile_of(confidences, 0.5);
  constexpr double kLeastMetres = 0.01, kLeastDepth = 0.001;
  double products = 0, squares = 0;
  MetricScale out;
  for (size_t s = 0; s < frames.size(); ++s) {
    const NetworkCamera& camera = frames[s].camera;
    const double per_unit = (camera.fx + camera.fy) / 2 / kDa3MetricFocal;
    const float *depth = frames[s].depth.data.data(), *other = metric[s].data.data();
    for (int64_t i = 0; i < metric[s].places(); ++i) {
      const double d = double(depth[2 * i]), metres = double(other[2 * i]) * per_unit;
      const bool used =
          is_ground(metric[s], i) && double(depth[2 * i + 1]) >= median && metres > kLeastMetres && d > kLeastDepth;
      if (!used) continue;
      products += metres * d;
      squares += d * d;
      ++out.pixels;
    }
  }
  if (out.pixels == 0 || !(squares > 0))
    throw_bad_input({}, "depth", "no pixel has a depth by both networks", "leave out photos that are dark or blank");
  out.scale = products / squares;
  return out;
}

MetricScale make_da3_metric(std::vector<Da3Frame>& frames, const std::vector<FeatureMap>& metric) {
  constexpr double kFar = 0.99, kFarthest = 200;  // metres
  const MetricScale found = da3_metric_scale(frames, metric);
  for (Da3Frame& frame : frames) {
    float* const v = frame.depth.data.data();
    for (int64_t i = 0; i < frame.depth.places(); ++i) v[2 * i] = float(double(v[2 * i]) * found.scale);
    for (double& t : frame.camera.translation) t *= found.scale;
  }
  const auto far = float(std::min(quantile_of(on_ground(frames, metric, 0), kFar), kFarthest));
  for (size_t s = 0; s < frames.size(); ++s) {
    float* const v = frames[s].depth.data.data();
    for (int64_t i = 0; i < metric[s].places(); ++i) {
      if (is_ground(metric[s], i)) continue;
      v[2 * i] = far;
      v[2 * i + 1] = 1;
    }
  }
  return found;
}

}  // namespace aligngs::nn
