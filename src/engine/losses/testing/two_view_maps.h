// Two views of a folded wall with a smooth texture, for the tests of the multi-view terms.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "engine/losses/testing/maps.h"

namespace aligngs::testing_maps {

/// The maps of LossFixture, seen from a second camera as well, whose depth map is that of the wall itself. The photos
/// show a texture painted on the wall, so that they agree across its planes.
struct TwoViewFixture : LossFixture {
  TrainingView other;
  std::vector<double> other_depth;
  uint64_t seed = 5;

  explicit TwoViewFixture(int width = 28, int height = 22) : LossFixture(width, height, 3) {
    other.data.name = "neighbour";
    Camera& camera = other.data.camera;
    camera = view.data.camera;
    camera.cx -= 0.7;
    camera.fy *= 1.02;
    camera.world_to_camera.rotation = rotation_matrix(normalized(Quaterniond{1, 0.01, 0.03, -0.02}));
    camera.world_to_camera.translation = {-0.12, 0.05, 0.04};
    other.data.color = ImageF(width, height, 3);
    other_depth.resize(pixels());
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Vec3d there = wall_point(camera, x, y);
        other_depth[size_t(y) * width + x] = (camera.world_to_camera * there).z;
        paint(there, x, y, other.data.color);
        paint(wall_point(view.data.camera, x, y), x, y, view.data.color);
      }
    }
  }

  /// Intersection of the ray of a pixel with the two walls of LossFixture, seen from inside: the nearer one.
  static Vec3d wall_point(const Camera& camera, int x, int y) {
    const Rigidd to_world = camera.world_to_camera.inverse();
    const Vec3d origin = to_world.translation, ray = to_world.rotation * camera.ray(x + 0.5, y + 0.5);
    double nearest = 1e9;
    for (const double side : {-0.55, 0.55}) {
      const Vec3d wall = normalized(Vec3d{side, 0.1, -1});
      const double t = -(3.0 + dot(wall, origin)) / dot(wall, ray);
      if (t > 0) nearest = std::min(nearest, t);
    }
    return origin + ray * nearest;
  }

  static void paint(const Vec3d& p, int x, int y, ImageF& photo) {
    for (int c = 0; c < 3; ++c) {
      photo.at(x, y, c) =
          static_cast<float>(0.5 + 0.2 * std::sin(4 * p.x + c) * std::cos(5 * p.y) + 0.1 * std::sin(9 * p.y + 3 * p.x));
    }
  }

  NeighbourView<double> neighbour() const { return {other, other_depth.data(), seed}; }

  LossTerms run(MapGradients<double>& gradients, ThreadPool* pool = nullptr,
                MapLossWorkspace<double>* workspace = nullptr) const {
    const NeighbourView<double> n = neighbour();
    LossTerms terms;
    gradients.reset(pixels());
    map_losses<double>({maps, view, settings, pool, workspace, &n}, terms, gradients);
    return terms;
  }
};

/// Every pixel shows exactly the plane n . X = -d.
inline void show_plane_everywhere(TwoViewFixture& f, const Vec3d& n, double d) {
  for (int y = 0; y < f.maps.height; ++y) {
    for (int x = 0; x < f.maps.width; ++x) show_plane(f, x, y, n, d);
  }
}

/// Largest error of the maps' gradients against central differences of `value(pixel)`, as a share of the largest
/// gradient. The value depends on the maps of its own pixel alone.
template <class Value>
double pixelwise_gradient_error(TwoViewFixture& f, const MapGradients<double>& analytic, const Value& value,
                                double h = 1e-6) {
  double worst = 0;
  const auto check = [&](std::vector<double>& map, const std::vector<double>& gradient) {
    for (size_t k = 0; k < map.size(); ++k) {
      const double start = map[k];
      map[k] = start + h;
      const double up = value(k % f.pixels());
      map[k] = start - h;
      const double down = value(k % f.pixels());
      map[k] = start;
      worst = std::max(worst, std::abs((up - down) / (2 * h) - gradient[k]));
    }
  };
  check(f.maps.normal, analytic.normal);
  check(f.maps.distance, analytic.distance);
  return worst / largest(analytic);
}

}  // namespace aligngs::testing_maps
