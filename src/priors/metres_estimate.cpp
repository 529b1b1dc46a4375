#include "priors/metres_estimate.h"

#include <algorithm>
#include <cmath>

#include "nn/da3/metric.h"
#include "nn/da3/metric_scale.h"
#include "scene/depth_placement.h"

namespace aligngs {
namespace {

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

}  // namespace

std::optional<double> log_metres_of_photo(const nn::Da3Frame& frame, const nn::FeatureMap& metric) {
  const nn::FeatureMap& depth = frame.depth;
  if (depth.width != metric.width || depth.height != metric.height || depth.channels != 2 || metric.channels != 2)
    return std::nullopt;
  const float *const d = depth.data.data(), *const m = metric.data.data();
  const auto is_ground = [&](int64_t i) { return m[2 * i + 1] < nn::kDa3SkyThreshold; };
  std::vector<float> confidences;
  for (int64_t i = 0; i < depth.places(); ++i) {
    if (is_ground(i) && std::isfinite(d[2 * i + 1])) confidences.push_back(d[2 * i + 1]);
  }
  if (confidences.empty()) return std::nullopt;
  const double sure = nn::quantile_of(std::move(confidences), 0.5);
  const double per_value = (frame.camera.fx + frame.camera.fy) / 2 / nn::kDa3MetricFocal;
  constexpr double kLeastMetres = 0.01, kLeastDepth = 0.001;  // as the published recipe has them
  std::vector<double> logs;
  for (int64_t i = 0; i < depth.places(); ++i) {
    const double unit = double(d[2 * i]), metres = double(m[2 * i]) * per_value;
    const bool used = is_ground(i) && double(d[2 * i + 1]) >= sure && std::isfinite(metres) && metres > kLeastMetres &&
                      std::isfinite(unit) && unit > kLeastDepth;
    if (used) logs.push_back(std::log(metres / unit));
  }
  const auto found = robust_log_scale(std::move(logs));
  return found ? std::optional(found->log) : std::nullopt;
}

std::optional<MetresEstimate> metres_estimate(std::vector<double> log_metres) {
  if (log_metres.empty()) return std::nullopt;
  constexpr double kNormal = 1.4826;  // standard deviation of a normal distribution per median absolute deviation
  MetresEstimate out;
  out.photos = log_metres.size();
  const double centre = median_of(log_metres);
  for (double& value : log_metres) value = std::abs(value - centre);
  out.scale = std::exp(centre);
  out.spread = kNormal * median_of(std::move(log_metres));
  return out;
}

}  // namespace aligngs
