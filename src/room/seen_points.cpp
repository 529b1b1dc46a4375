#include "room/seen_points.h"

#include "core/is_depth.h"
#include "scene/depth_normals.h"

namespace aligngs {
namespace {

constexpr int kSurfaceRadius = 4;  // pixels: trained surfaces are rough

}  // namespace

SeenPoint seen_point(const MeasuredView& view, int x, int y, const Similarity& to_frame) {
  SeenPoint out;
  const double z = view.depth.at(x, y);
  out.from = to_frame * view.camera.centre();
  out.to = to_frame * view.camera.unproject(x + 0.5, y + 0.5, z);
  out.depth = to_frame.scale * z;
  return out;
}

ImageF surface_normals(const MeasuredView& view) {
  DepthNormalOptions options;
  options.radius = kSurfaceRadius;
  return camera_normals(view.depth, view.camera, options);
}

std::vector<SeenPoint> seen_points(const std::vector<MeasuredView>& views, const Similarity& to_frame, int stride,
                                   ThreadPool& pool) {
  std::vector<std::vector<SeenPoint>> per_view(views.size());
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const MeasuredView& view = views[i];
      if (view.depth.empty()) continue;
      const ImageF normals = surface_normals(view);
      const Mat3d turn = to_frame.rotation * transpose(view.camera.world_to_camera.rotation);
      for (int y = stride / 2; y < view.depth.height; y += stride) {
        for (int x = stride / 2; x < view.depth.width; x += stride) {
          if (!is_depth(view.depth.at(x, y))) continue;
          SeenPoint point = seen_point(view, x, y, to_frame);
          point.normal = turn * Vec3d{normals.at(x, y, 0), normals.at(x, y, 1), normals.at(x, y, 2)};
          per_view[i].push_back(point);
        }
      }
    }
  });
  std::vector<SeenPoint> points;
  for (const auto& some : per_view) points.insert(points.end(), some.begin(), some.end());
  return points;
}

}  // namespace aligngs
