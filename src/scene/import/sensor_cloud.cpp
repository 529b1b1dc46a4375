#include "scene/import/sensor_cloud.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/median.h"
#include "io/image_file.h"
#include "io/resample.h"
#include "scene/depth_agreement.h"
#include "scene/depth_cloud.h"

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

std::string SensorCloud::other_unit(bool metric) const {
  constexpr double kNear = 0.1, kFar = 50;  // metres: medians of rooms and halls lie far between
  constexpr const char* kHint = "another unit than this layout has (docs/formats.md)";
  const double typical = median_depth(depths_);
  if (metric && typical > 0 && (typical < kNear || typical > kFar))
    return fmt::format("the median depth is {:.3g} m, which is no room: depth has {}", typical, kHint);
  const DepthAgreement agreement = depth_agreement(cameras_, depths_);
  if (!agreement.has_other_unit()) return {};
  return fmt::format(
      "the views' depth contradicts itself, but agrees to {:.1f} % as {:.3g} times what it is: depth or cameras have "
      "{}",
      100 * agreement.scaled_difference, agreement.factor, kHint);
}

PointCloud SensorCloud::fuse(double voxel, ThreadPool& pool) const {
  std::vector<DepthCloudView> views;
  for (size_t i = 0; i < cameras_.size(); ++i) views.push_back({cameras_[i], &depths_[i], &colors_[i], nullptr});
  DepthCloudOptions options;
  options.voxel = voxel;
  return fuse_depth_cloud(views, options, pool).cloud;
}

}  // namespace aligngs
