#include "synth/sfm_cloud.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "io/image_file.h"

namespace aligngs {
namespace {

/// Place of the point in a photo.
struct Sighting {
  size_t view;
  Vec2d pixel;
};

Vec3d world_ray(const Camera& camera, const Vec2d& pixel) {
  const Vec3d ray = camera.world_to_camera.inverse().rotation * camera.ray(pixel.x, pixel.y);
  return ray * (1 / std::sqrt(dot(ray, ray)));
}

/// The point nearest to all rays, if it fits them.
bool triangulate(const std::vector<SfmView>& views, const std::vector<Sighting>& track, const SfmSettings& settings,
                 Vec3d& point) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double smallest_cosine = 1;
  std::vector<Vec3d> rays;
  for (const Sighting& o : track) {
    const Vec3d d = world_ray(views[o.view].camera, o.pixel), c = views[o.view].camera.centre();
    for (const Vec3d& other : rays) smallest_cosine = std::min(smallest_cosine, dot(d, other));
    rays.push_back(d);
    const Eigen::Vector3d direction(d.x, d.y, d.z);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - direction * direction.transpose();
    normal += across;
    right += across * Eigen::Vector3d(c.x, c.y, c.z);
  }
  if (smallest_cosine > std::cos(settings.smallest_parallax * kRadiansPerDegree)) return false;
  const Eigen::Vector3d x = normal.ldlt().solve(right);
  if (!x.allFinite()) return false;
  point = {x[0], x[1], x[2]};
  for (const Sighting& o : track) {
    const Camera& camera = views[o.view].camera;
    const Vec3d p = camera.world_to_camera * point;
    if (p.z <= 0) return false;
    const Vec2d at = camera.project(p);
    if (std::hypot(at.x - o.pixel.x, at.y - o.pixel.y) > settings.largest_residual) return false;
  }
  return true;
}

/// The photos that see the surface point behind a corner and match it.
std::vector<Sighting> track_of(const std::vector<SfmView>& views, size_t first, const Vec3d& world,
                               const SfmSettings& settings, Random& random) {
  std::vector<Sighting> track;
  for (size_t v = 0; v < views.size(); ++v) {
    const Camera& camera = views[v].truth->camera;
    const Vec3d p = camera.world_to_camera * world;
    if (p.z <= 0) continue;
    const Vec2d at = camera.project(p);
    if (!camera.contains(at)) continue;
    const double depth = views[v].truth->depth.at(static_cast<int>(at.x), static_cast<int>(at.y));
    if (!(depth > 0) || std::abs(depth - p.z) > settings.same_depth * p.z) continue;
    if (v != first && !random.chance(settings.found)) continue;
    track.push_back(
        {v, {at.x + settings.pixel_noise * random.normal(), at.y + settings.pixel_noise * random.normal()}});
  }
  return track;
}

}  // namespace

PointCloud simulate_sfm_cloud(const std::vector<SfmView>& views, const SfmSettings& settings, Random random) {
  PointCloud cloud;
  for (size_t v = 0; v < views.size(); ++v) {
    const RenderedView& truth = *views[v].truth;
    const ImageF luma = luma_of(to_float(*views[v].photo));
    CornerSettings corners = settings.corners;
    corners.per_view = static_cast<int>(std::lround(corners.per_view * relative_size(luma)));
    for (const Corner& corner : find_corners(luma, {}, corners)) {
      const double depth = truth.depth.at(corner.x, corner.y);
      if (!(depth > 0)) continue;
      const Vec3d world = truth.camera.unproject(corner.x + 0.5, corner.y + 0.5, depth);
      const std::vector<Sighting> track = track_of(views, v, world, settings, random);
      Vec3d point;
      // A point that several photos have as a corner is kept by the first of its track only.
      if (track.size() < 2 || track.front().view != v || !triangulate(views, track, settings, point)) continue;
      cloud.positions.push_back(point.cast<float>());
      const uint8_t* c = views[v].photo->pixel(corner.x, corner.y);
      cloud.colors.push_back(
          {static_cast<float>(c[0]) / 255, static_cast<float>(c[1]) / 255, static_cast<float>(c[2]) / 255});
    }
  }
  return cloud;
}

}  // namespace aligngs
