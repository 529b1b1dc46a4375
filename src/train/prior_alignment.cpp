#include "train/prior_alignment.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/is_depth.h"
#include "core/median.h"
#include "scene/depth_placement.h"

namespace aligngs {
namespace {

class LogRatios {
 public:
  explicit LogRatios(const PriorAlignmentRule& rule) : rule_(rule), outlier_(std::log1p(rule.outlier)) {}

  void add(double reference, double prior) {
    if (!is_depth(reference) || !is_depth(prior)) return;
    const double ratio = std::log(reference / prior);
    if (std::abs(ratio) <= outlier_) ratios_.push_back(ratio);
  }

  std::optional<float> scale() {
    if (ratios_.empty() || ratios_.size() < rule_.min_samples) return std::nullopt;
    return static_cast<float>(std::clamp(std::exp(median_of(ratios_)), 1 - rule_.limit, 1 + rule_.limit));
  }

 private:
  const PriorAlignmentRule& rule_;
  double outlier_;
  std::vector<double> ratios_;
};

bool counts(const ImageF& weight, int x, int y) { return weight.empty() || weight.at(x, y) > 0; }

}  // namespace

std::optional<float> align_prior_to_depth(const ImageF& prior, const ImageF& weight, const ImageF& reference,
                                          const PriorAlignmentRule& rule) {
  LogRatios ratios(rule);
  if (prior.width != reference.width || prior.height != reference.height) return std::nullopt;
  for (int y = 0; y < prior.height; ++y) {
    for (int x = 0; x < prior.width; ++x) {
      if (counts(weight, x, y)) ratios.add(reference.at(x, y), prior.at(x, y));
    }
  }
  return ratios.scale();
}

std::optional<float> align_prior_to_points(const ImageF& prior, const ImageF& weight, const Camera& camera,
                                           const PointCloud& cloud, const PriorAlignmentRule& rule) {
  LogRatios ratios(rule);
  if (prior.width != camera.width || prior.height != camera.height) return std::nullopt;
  for (const Vec3f& point : cloud.positions) {
    const Vec3d c = camera.world_to_camera * point.cast<double>();
    if (!(c.z > 0)) continue;
    const Vec2d image = camera.project(c);
    if (!camera.contains(image)) continue;
    const int x = static_cast<int>(image.x), y = static_cast<int>(image.y);
    if (counts(weight, x, y)) ratios.add(c.z, prior.at(x, y));
  }
  return ratios.scale();
}

std::optional<float> find_prior_scale(const ImageF& prior, const ImageF& weight, const ImageF& reference,
                                      const PriorAlignmentRule& rule) {
  if (prior.width != reference.width || prior.height != reference.height) return std::nullopt;
  std::vector<double> ratios;
  for (int y = 0; y < prior.height; ++y) {
    for (int x = 0; x < prior.width; ++x) {
      const double z = reference.at(x, y), p = prior.at(x, y);
      if (counts(weight, x, y) && is_depth(z) && is_depth(p)) ratios.push_back(std::log(z / p));
    }
  }
  const auto found = robust_log_scale(std::move(ratios), {rule.min_samples, rule.outlier});
  if (!found) return std::nullopt;
  return static_cast<float>(std::exp(found->log));
}

}  // namespace aligngs
