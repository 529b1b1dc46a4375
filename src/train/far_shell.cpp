#include "train/far_shell.h"

#include <algorithm>
#include <cmath>

#include "core/is_depth.h"
#include "core/median.h"
#include "gaussians/initialise.h"

namespace aligngs {
namespace {

constexpr double kShellGrowth = 1.3;  // of the cubes' edge, while there are too many points

/// Whether no pixel near this one has depth, and the photo counts.
bool is_open(const TrainingView& view, int x, int y, int clearance) {
  const ImageF& depth = view.data.prior_depth;
  if (!view.data.mask.empty() && !(view.data.mask.at(x, y) > 0.5f)) return false;
  for (int v = std::max(0, y - clearance); v <= std::min(depth.height - 1, y + clearance); ++v) {
    for (int u = std::max(0, x - clearance); u <= std::min(depth.width - 1, x + clearance); ++u) {
      if (is_depth(depth.at(u, v))) return false;
    }
  }
  return true;
}

}  // namespace

MeasuredHull measured_room(const std::vector<TrainingView>& views, const std::vector<float>& depth_scales) {
  std::vector<Camera> cameras;
  std::vector<ImageF> scaled;
  for (size_t i = 0; i < views.size(); ++i) {
    cameras.push_back(views[i].data.camera);
    scaled.push_back(views[i].data.prior_depth);
    for (float& z : scaled.back().data) z *= depth_scales[i];
  }
  std::vector<const ImageF*> depths;
  for (const ImageF& map : scaled) depths.push_back(&map);
  return {cameras, depths};
}

PointCloud far_shell(const std::vector<TrainingView>& views, const MeasuredHull& room, double extent, size_t most,
                     const FarShellSettings& s) {
  PointCloud all;
  std::vector<double> footprints;
  for (const TrainingView& view : views) {
    const Camera& camera = view.data.camera;
    const Mat3d to_world = transpose(camera.world_to_camera.rotation);
    const Vec3d centre = camera.centre();
    if (view.data.prior_depth.empty()) continue;
    for (int y = s.stride / 2; y < camera.height; y += s.stride) {
      for (int x = s.stride / 2; x < camera.width; x += s.stride) {
        if (!is_open(view, x, y, s.clearance)) continue;
        const Vec3d ray = to_world * camera.ray(x + 0.5, y + 0.5);
        const double z = room.exit(centre, ray, s.gap * extent);
        if (!(z > 0)) continue;
        all.positions.push_back((centre + ray * z).cast<float>());
        all.normals.push_back(normalized(-ray).cast<float>());
        const float* c = view.data.color.pixel(x, y);
        all.colors.push_back({c[0], c[1], c[2]});
        footprints.push_back(z * s.stride / camera.fx);
      }
    }
  }
  if (all.positions.empty() || most == 0) return {};
  double edge = s.spacing * median_of(std::move(footprints));
  PointCloud thin = voxel_thin(all, edge);
  while (thin.size() > most) thin = voxel_thin(all, edge *= kShellGrowth);
  return thin;
}

}  // namespace aligngs
