#include "scene/colmap_model.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

ColmapCamera colmap_camera(uint32_t id, const Camera& camera) {
  ColmapCamera out;
  out.id = id;
  out.model = "PINHOLE";
  out.width = static_cast<uint64_t>(camera.width);
  out.height = static_cast<uint64_t>(camera.height);
  out.params = {camera.fx, camera.fy, camera.cx, camera.cy};
  return out;
}

}  // namespace

void append_view(ColmapModel& model, const Camera& camera, const std::string& image_name) {
  const ColmapCamera wanted = colmap_camera(static_cast<uint32_t>(model.cameras.size() + 1), camera);
  const auto same = std::find_if(model.cameras.begin(), model.cameras.end(), [&](const ColmapCamera& c) {
    return c.width == wanted.width && c.height == wanted.height && c.params == wanted.params;
  });
  ColmapImage image;
  image.camera_id = same == model.cameras.end() ? wanted.id : same->id;
  if (same == model.cameras.end()) model.cameras.push_back(wanted);
  image.id = static_cast<uint32_t>(model.images.size() + 1);
  image.rotation = quaternion_of(camera.world_to_camera.rotation);
  image.translation = camera.world_to_camera.translation;
  image.name = image_name;
  model.images.push_back(image);
}

void append_points(ColmapModel& model, const PointCloud& cloud) {
  for (size_t i = 0; i < cloud.size(); ++i) {
    ColmapPoint point;
    point.id = i + 1;
    point.position = cloud.positions[i].cast<double>();
    for (int k = 0; k < 3; ++k) {
      point.color[k] = static_cast<uint8_t>(std::lround(std::clamp(cloud.colors[i][k], 0.0f, 1.0f) * 255));
    }
    model.points.push_back(point);
  }
}

}  // namespace aligngs
