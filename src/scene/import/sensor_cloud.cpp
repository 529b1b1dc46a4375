#include "scene/import/sensor_cloud.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/median.h"
#include "io/image_file.h"
#include "io/resample.h"
#include "scene/depth_agreement.h"
#include "scene/depth_cloud.h"
#include "scene/scene_check.h"

namespace aligngs {
namespace {

/// The median of samples; 0 without any.
double median_depth(const std::vector<ImageF>& depths) {
  constexpr size_t kStep = 101;  // prime, so that columns differ from row to row
  std::vector<float> samples;
  for (const ImageF& depth : depths) {
    for (size_t i = 0; i < depth.data.size(); i += kStep)
      if (depth.data[i] > 0) samples.push_back(depth.data[i]);
  }
  return median_of(std::move(samples));
}

/// The median of depth over the distance of points that came with the capture; 0 where they agree or are too few.
double times_of_points(const PointCloud& points, const std::vector<Camera>& cameras,
                       const std::vector<ImageF>& depths) {
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

std::string unit_remedy(double unit, double factor) {
  return fmt::format(
      "depth or cameras have another unit than this layout has. A stored value counts as {:.4g} here, and seems to "
      "mean "
      "{:.4g}: convert the depth, scale the poses, or say it in a transforms.json (depth_unit_scale_factor)",
      unit, unit * factor);
}

const char* text_of(PoseMisreading misreading) {
  return misreading == PoseMisreading::kAxes
             ? "with y and z of the cameras turned round (OpenGL's axes against OpenCV's)"
             : "with inverted matrices (world-to-camera against camera-to-world)";
}

}  // namespace

void SensorCloud::add(const Camera& camera, const ImageF& depth, const Image<uint8_t>& pixels) {
  ImageF color = to_float(pixels);
  if (color.channels == 4) {
    ImageF rgb(color.width, color.height, 3);
    for (size_t i = 0; i < rgb.pixels(); ++i) std::copy_n(&color.data[4 * i], 3, &rgb.data[3 * i]);
    color = std::move(rgb);
  }
  cameras_.push_back(camera.resized(depth.width, depth.height));
  depths_.push_back(depth);
  colors_.push_back(resize_area(color, depth.width, depth.height));
}

std::string SensorCloud::contradiction(bool metric, double unit, const PointCloud& points) const {
  constexpr double kNear = 0.1, kFar = 50;  // metres: medians of rooms and halls lie far between
  const double typical = median_depth(depths_);
  if (metric && typical > 0 && (typical < kNear || typical > kFar))
    return fmt::format(
        "the median depth is {:.3g} m, which is no room: depth has another unit than this layout has (docs/formats.md)",
        typical);
  if (const double times = times_of_points(points, cameras_, depths_); times > 0)
    return fmt::format("depth is {:.3g} times the distance of the points that came with it: {}", times,
                       unit_remedy(unit, 1 / times));
  const DepthAgreement agreement = depth_agreement(cameras_, depths_);
  if (agreement.misreading != PoseMisreading::kNone &&
      !(agreement.has_other_unit() && agreement.scaled_difference < agreement.read_difference))
    return fmt::format(
        "the views' depth contradicts itself, but agrees to {:.1f} % {}; docs/formats.md says what this "
        "layout has",
        100 * agreement.read_difference, text_of(agreement.misreading));
  if (!agreement.has_other_unit()) return {};
  return fmt::format("the views' depth contradicts itself, but agrees to {:.1f} % as {:.3g} times what it is: {}",
                     100 * agreement.scaled_difference, agreement.factor, unit_remedy(unit, agreement.factor));
}

PointCloud SensorCloud::fuse(double voxel, ThreadPool& pool) const {
  std::vector<DepthCloudView> views;
  for (size_t i = 0; i < cameras_.size(); ++i) views.push_back({cameras_[i], &depths_[i], &colors_[i], nullptr});
  DepthCloudOptions options;
  options.voxel = voxel;
  return fuse_depth_cloud(views, options, pool).cloud;
}

}  // namespace aligngs
