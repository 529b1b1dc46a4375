#include "scene/exposure_prediction.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

constexpr size_t kNearest = 3;       // views that are averaged
constexpr double kSamePlace = 0.05;  // distance below which views count alike: 3 degrees, or a twentieth of the extent
constexpr double kLeastGain = 0.5;   // squared error of the prediction over that of no prediction, at most

/// Extents between two cameras plus radians between their directions.
double distance(const Camera& a, const Camera& b, double extent) {
  const double cosine = std::clamp(dot(a.forward(), b.forward()), -1.0, 1.0);
  return norm(a.centre() - b.centre()) / extent + std::acos(cosine);
}

/// From the training views but `without`.
Vec3f predict(const Scene& scene, int view, int without, double extent) {
  std::vector<std::pair<double, int>> near;
  for (const int t : scene.train) {
    if (t != without)
      near.emplace_back(
          distance(scene.views[static_cast<size_t>(view)].camera, scene.views[static_cast<size_t>(t)].camera, extent),
          t);
  }
  std::sort(near.begin(), near.end());
  Vec3d sum;
  double weights = 0;
  for (size_t k = 0; k < std::min(kNearest, near.size()); ++k) {
    const double weight = 1 / (near[k].first * near[k].first + kSamePlace * kSamePlace);
    sum += scene.views[static_cast<size_t>(near[k].second)].log_gain.cast<double>() * weight;
    weights += weight;
  }
  return weights > 0 ? (sum * (1 / weights)).cast<float>() : Vec3f{};
}

}  // namespace

std::vector<Vec3f> predict_log_gains(const Scene& scene) {
  std::vector<Vec3f> gains(scene.views.size());
  const double extent = robust_extent(scene);
  double unpredicted = 0, left = 0;
  for (const int t : scene.train) {
    const Vec3f& own = scene.views[static_cast<size_t>(t)].log_gain;
    const Vec3f error = own - predict(scene, t, t, extent);
    gains[static_cast<size_t>(t)] = own;
    unpredicted += static_cast<double>(dot(own, own));
    left += static_cast<double>(dot(error, error));
  }
  if (!(left < kLeastGain * unpredicted)) return gains;
  for (const int t : scene.test) gains[static_cast<size_t>(t)] = predict(scene, t, t, extent);
  return gains;
}

}  // namespace aligngs
