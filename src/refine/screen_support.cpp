#include "refine/screen_support.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "scene/depth_normals.h"

namespace aligngs {
namespace {

bool is_panel(const PlaneView& view, const std::vector<PanelClass>& classes, int x, int y) {
  const uint16_t label = view.labels.at(x, y);
  return label < classes.size() && classes[label] != PanelClass::kNone;
}

std::vector<Vec3d> tops_of(const PlaneView& view, const std::vector<PanelClass>& classes, const Vec3d& vertical,
                           const SupportSettings& s) {
  std::vector<Vec3d> out;
  if (view.labels.data.empty() || view.depth.empty()) return out;
  const ImageF normals = camera_normals(view.depth, view.camera);
  const Vec3d up = view.camera.world_to_camera.rotation * vertical;
  const Rigidd to_world = view.camera.world_to_camera.inverse();
  for (int y = s.stride / 2; y < view.depth.height; y += s.stride) {
    for (int x = s.stride / 2; x < view.depth.width; x += s.stride) {
      const Vec3d normal{normals.at(x, y, 0), normals.at(x, y, 1), normals.at(x, y, 2)};
      if (is_panel(view, classes, x, y) || dot(normal, up) < s.level_cosine) continue;
      out.push_back(to_world * (view.camera.ray(x + 0.5, y + 0.5) * static_cast<double>(view.depth.at(x, y))));
    }
  }
  return out;
}

}  // namespace

ScreenSupport::ScreenSupport(const std::vector<PlaneView>& views, const std::vector<PanelClass>& classes,
                             const std::vector<ScenePlane>& planes, const SupportSettings& settings, ThreadPool& pool)
    : planes_(planes), settings_(settings) {
  const std::optional<Vec3d> vertical = vertical_of(planes);
  if (!vertical) return;
  std::vector<std::vector<Vec3d>> per_view(views.size());
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t v = begin; v < end; ++v) per_view[v] = tops_of(views[v], classes, *vertical, settings_);
  });
  for (const std::vector<Vec3d>& tops : per_view) tops_.insert(tops_.end(), tops.begin(), tops.end());
}

bool ScreenSupport::hangs(const Panel& panel) const {
  const double least_cosine = std::cos(settings_.parallel * kRadiansPerDegree);
  return std::any_of(planes_.begin(), planes_.end(), [&](const ScenePlane& plane) {
    if (plane.kind != PlaneKind::kWall || dot(plane.normal, panel.normal) < least_cosine) return false;
    return std::abs(plane.distance(panel.centre())) < settings_.hangs_within * panel.depth;
  });
}

bool ScreenSupport::stands(const Panel& panel) const {
  size_t under = 0;
  for (const Vec3d& top : tops_) {
    const double u = dot(panel.across, top), v = dot(panel.up, top);
    if (u < panel.low[0] || u > panel.high[0] || std::abs(panel.distance(top)) > settings_.foot * panel.depth) continue;
    const double gap = (panel.low[1] - v) / panel.depth;
    under += gap < settings_.gap && gap > -settings_.overlap ? 1 : 0;
  }
  return under >= settings_.least_points;
}

}  // namespace aligngs
