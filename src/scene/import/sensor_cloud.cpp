#include "scene/import/sensor_cloud.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/image_file.h"
#include "io/resample.h"
#include "scene/depth_cloud.h"
#include "scene/depth_contradiction.h"

namespace aligngs {
namespace {

std::string unit_remedy(double unit, double factor) {
  return fmt::format(
      "depth or cameras have another unit than this layout has. A stored value counts as {:.4g} here, and seems to "
      "mean {:.4g}: convert the depth, scale the poses, or say it in a transforms.json (depth_unit_scale_factor)",
      unit, unit * factor);
}

/// No depth where the alpha of a photo hides at least half of a pixel.
void hide_depth(const ImageF& alpha, ImageF& depth) {
  constexpr float kSeen = 0.5f;
  for (size_t i = 0; i < depth.data.size(); ++i) {
    if (alpha.data[i] < kSeen) depth.data[i] = 0;
  }
}

}  // namespace

void SensorCloud::add(const Camera& camera, const ImageF& depth, const Image<uint8_t>& pixels) {
  ImageF color = to_float(pixels);
  cameras_.push_back(camera.resized(depth.width, depth.height));
  depths_.push_back(depth);
  if (color.channels == 4) {
    ImageF rgb(color.width, color.height, 3), alpha(color.width, color.height, 1);
    for (size_t i = 0; i < rgb.pixels(); ++i) {
      std::copy_n(&color.data[4 * i], 3, &rgb.data[3 * i]);
      alpha.data[i] = color.data[4 * i + 3];
    }
    color = std::move(rgb);
    hide_depth(resize_area(alpha, depth.width, depth.height), depths_.back());
  }
  colors_.push_back(resize_area(color, depth.width, depth.height));
}

std::string SensorCloud::contradiction(bool metric, double unit, const PointCloud& points) const {
  const auto found = depth_contradiction(cameras_, depths_, points, metric);
  if (!found) return {};
  return found->message +
         (found->factor != 1 ? ": " + unit_remedy(unit, found->factor) : "; docs/formats.md says what this layout has");
}

PointCloud SensorCloud::fuse(double voxel, ThreadPool& pool) const {
  std::vector<DepthCloudView> views;
  for (size_t i = 0; i < cameras_.size(); ++i) views.push_back({cameras_[i], &depths_[i], &colors_[i], nullptr});
  DepthCloudOptions options;
  options.voxel = voxel;
  return fuse_depth_cloud(views, options, pool).cloud;
}

}  // namespace aligngs
