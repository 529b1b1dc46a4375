#include "refine/class_fit.h"

#include <algorithm>
#include <cmath>

#include "refine/plane_depth.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

/// Measured pixels of each class on each plane.
using Counts = std::vector<std::vector<double>>;

void count(const MeasuredView& view, const std::vector<ScenePlane>& planes, double reach, Counts& counts) {
  const std::vector<CameraPlane> seen = in_frame_of(view.camera, planes);
  for (int y = 0; y < view.labels.height; ++y) {
    for (int x = 0; x < view.labels.width; ++x) {
      const uint16_t label = view.labels.at(x, y);
      const double z = static_cast<double>(view.depth.at(x, y));
      if (label == kNoLabel || !(z > 0)) continue;
      const Vec3d ray = view.camera.ray(x + 0.5, y + 0.5);
      for (const CameraPlane& plane : seen) {
        const double there = plane.depth(ray);
        if (!(there > 0) || std::abs(std::log(there / z)) >= reach) continue;
        std::vector<double>& of_plane = counts[plane.number - 1u];
        if (of_plane.size() <= label) of_plane.resize(label + 1u);
        of_plane[label] += 1;
      }
    }
  }
}

}  // namespace

std::vector<std::vector<float>> class_fit(const std::vector<MeasuredView>& views, const std::vector<ScenePlane>& planes,
                                          const ClassFitSettings& settings) {
  Counts counts(planes.size());
  for (const MeasuredView& view : views) {
    if (!view.labels.empty()) count(view, planes, settings.reach, counts);
  }
  std::vector<std::vector<float>> fit(planes.size());
  for (size_t k = 0; k < counts.size(); ++k) {
    double all = 0;
    for (const double n : counts[k]) all += n;
    for (const double n : counts[k])
      fit[k].push_back(static_cast<float>(std::min(1.0, n / (settings.usual_share * all))));
  }
  return fit;
}

}  // namespace aligngs
