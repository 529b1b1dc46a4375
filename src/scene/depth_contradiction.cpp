#include "scene/depth_contradiction.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "core/median.h"
#include "scene/depth_agreement.h"
#include "scene/scene_check.h"

namespace aligngs {
namespace {

/// The median of samples; 0 without any.
double median_depth(std::span<const ImageF> depths) {
  constexpr size_t kStep = 101;  // prime, so that columns differ from row to row
  std::vector<float> samples;
  for (const ImageF& depth : depths) {
    for (size_t i = 0; i < depth.data.size(); i += kStep)
      if (depth.data[i] > 0) samples.push_back(depth.data[i]);
  }
  return median_of(std::move(samples));
}

/// The median of depth over the distance of points that came with the capture; 0 where they agree or are too few.
double times_of_points(const PointCloud& points, std::span<const Camera> cameras, std::span<const ImageF> depths) {
  constexpr int kFewPoints = 100;  // of all views together
  constexpr double kAlike = 1.25;  // factor: sparse points and noise of sensors stay below
  std::vector<double> ratios;
  int count = 0;
  for (size_t i = 0; i < cameras.size(); ++i) {
    const DisparityEvidence evidence = disparity_evidence(points, cameras[i], depths[i]);
    if (!evidence.is_enough()) continue;
    ratios.push_back(evidence.ratio);
    count += evidence.points;
  }
  const double times = count < kFewPoints ? 1 : median_of(std::move(ratios));
  return times > kAlike || times < 1 / kAlike ? times : 0;
}

/// Median distance of cameras from their middle, scene units.
double spread_of(std::span<const Camera> cameras) {
  Vec3d middle;
  for (const Camera& camera : cameras) middle += camera.centre() * (1.0 / static_cast<double>(cameras.size()));
  std::vector<double> distances;
  for (const Camera& camera : cameras) distances.push_back(norm(camera.centre() - middle));
  return median_of(std::move(distances));
}

const char* text_of(Misreading misreading) {
  switch (misreading) {
    case Misreading::kAxes:
      return "with y and z of the cameras turned round (OpenGL's axes against OpenCV's)";
    case Misreading::kInverted:
      return "with inverted matrices (world-to-camera against camera-to-world)";
    case Misreading::kAlongRays:
      return "as distances along the rays (the maps should hold z of the camera)";
    case Misreading::kUpsideDown:
      return "upside down (the maps' last row is the photos' first)";
    case Misreading::kNone:
      break;
  }
  return "";
}

}  // namespace

std::optional<DepthContradiction> depth_contradiction(std::span<const Camera> cameras, std::span<const ImageF> depths,
                                                      const PointCloud& points, bool metric) {
  constexpr double kNear = 0.1, kFar = 50;  // metres: medians of rooms and halls lie far between
  const double typical = median_depth(depths);
  if (metric && typical > 0 && (typical < kNear || typical > kFar))
    return DepthContradiction{fmt::format("the median depth is {:.3g} m, which is no room", typical)};
  constexpr double kLeastOfSpread = 0.01;  // a walk through a long corridor has some 0.05
  if (const double spread = spread_of(cameras); typical > 0 && typical < kLeastOfSpread * spread)
    return DepthContradiction{
        fmt::format("the median depth is {:.2g} % of the cameras' distance from their middle", 100 * typical / spread)};
  if (const double times = times_of_points(points, cameras, depths); times > 0)
    return DepthContradiction{fmt::format("depth is {:.3g} times the distance of the points that came with it", times),
                              1 / times};
  const DepthAgreement agreement = depth_agreement(cameras, depths);
  if (agreement.misreading != Misreading::kNone &&
      !(agreement.has_other_unit() && agreement.scaled_difference < agreement.read_difference))
    return DepthContradiction{fmt::format("the views' depth contradicts itself, but agrees to {:.1f} % {}",
                                          100 * agreement.read_difference, text_of(agreement.misreading))};
  if (!agreement.has_other_unit() && agreement.is_contradicted())
    return DepthContradiction{fmt::format(
        "the views' depth contradicts itself by {:.0f} %: depth, poses or intrinsics are wrong, or of other photos",
        100 * agreement.difference)};
  if (!agreement.has_other_unit()) return {};
  return DepthContradiction{fmt::format("the views' depth contradicts itself, but agrees to {:.1f} % as {:.3g} times "
                                        "what it is",
                                        100 * agreement.scaled_difference, agreement.factor),
                            agreement.factor};
}

}  // namespace aligngs
