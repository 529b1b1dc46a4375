// Photos of a corner of a textured room, drawn in closed form: two walls and a floor, so that depth has parallax.
#pragma once

#include <cmath>
#include <vector>

#include "core/angles.h"
#include "core/random.h"
#include "refine/refine_cameras.h"

namespace aligngs::wall_photos {

inline constexpr int kWidth = 160, kHeight = 120;
inline constexpr double kFocal = 140;  // pixels

inline double texture(double u, double v) {
  return 0.5 + 0.2 * std::sin(11 * u + 3 * std::sin(4 * v)) * std::cos(9 * v + 2 * std::sin(5 * u)) +
         0.15 * std::sin(23 * u - 5 * v + 3 * std::sin(2 * u * v)) + 0.1 * std::cos(17 * v + 7 * u);
}

/// Nearest of the planes z = 3, x = 1.2 and y = 0.8 along a ray from `origin`: distance in units of the ray, and
/// texture.
inline double trace(const Vec3d& origin, const Vec3d& ray, double& value) {
  double best = 1e30;
  const auto hit = [&](double t, double u, double v) {
    if (!(t > 1e-6) || t >= best) return;
    best = t;
    value = texture(u, v);
  };
  const double back = (3 - origin.z) / ray.z, right = (1.2 - origin.x) / ray.x, floor = (0.8 - origin.y) / ray.y;
  hit(back, origin.x + back * ray.x, origin.y + back * ray.y);
  hit(right, 2.7 + origin.z + right * ray.z, origin.y + right * ray.y);
  hit(floor, origin.x + floor * ray.x, 1.3 + origin.z + floor * ray.z);
  return best;
}

inline Camera true_camera(int i) {
  const double turn = 0.06 * i - 0.2, c = std::cos(turn), s = std::sin(turn);
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = kFocal;
  camera.cx = kWidth / 2.0;
  camera.cy = kHeight / 2.0;
  camera.world_to_camera.rotation = Mat3d{{c, 0, -s, 0, 1, 0, s, 0, c}};
  const Vec3d centre{-0.6 + 0.15 * i, 0.05 * (i % 3), 0.06 * (i % 4)};
  camera.world_to_camera.translation = -(camera.world_to_camera.rotation * centre);
  return camera;
}

/// Grain of the walls, [-0.5, 0.5]: cubes of 6 cm, three pixels or so, no two alike.
inline double grain(const Vec3d& p) {
  uint64_t hash = 0;
  for (int k = 0; k < 3; ++k) {  // the shift keeps the walls off the cubes' faces
    hash =
        (hash ^ static_cast<uint64_t>(static_cast<int64_t>(std::floor((p[k] + 0.013) / 0.06)))) * 0x9e3779b97f4a7c15ull;
    hash ^= hash >> 29;
  }
  return static_cast<double>(hash % 1000) / 999 - 0.5;
}

/// Exact photo and depth of a camera. The texture alone looks alike in many places; with `roughness` none does.
inline RefineView photo(const Camera& camera, double roughness = 0) {
  RefineView view;
  view.match.camera = camera;
  view.match.luma = ImageF(kWidth, kHeight, 1);
  view.match.depth = ImageF(kWidth, kHeight, 1);
  const Mat3d to_world = transpose(camera.world_to_camera.rotation);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      double value = 0;
      const double z = trace(camera.centre(), to_world * camera.ray(x + 0.5, y + 0.5), value);
      const Vec3d place = camera.centre() + to_world * camera.ray(x + 0.5, y + 0.5) * z;
      view.match.luma.at(x, y) = static_cast<float>(value + roughness * grain(place));
      view.match.depth.at(x, y) = static_cast<float>(z);
    }
  }
  view.color = ImageF(kWidth, kHeight, 3, 0.5f);
  return view;
}

inline Camera disturbed(Camera camera, double degrees, double shift, Random& random) {
  const double k = kRadiansPerDegree;
  const double a = degrees * k * random.normal(), b = degrees * k * random.normal();
  const Mat3d about_x{{1, 0, 0, 0, std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a)}};
  const Mat3d about_y{{std::cos(b), 0, std::sin(b), 0, 1, 0, -std::sin(b), 0, std::cos(b)}};
  const Vec3d centre =
      camera.centre() + Vec3d{shift * random.normal(), shift * random.normal(), shift * random.normal()};
  camera.world_to_camera.rotation = about_x * about_y * camera.world_to_camera.rotation;
  camera.world_to_camera.translation = -(camera.world_to_camera.rotation * centre);
  return camera;
}

/// `count` photos with cameras that are wrong by `degrees` and `shift`; the last `tests` of them are test photos.
inline std::vector<RefineView> photos(int count, int tests, double degrees, double shift) {
  Random random(7);
  std::vector<RefineView> views;
  for (int i = 0; i < count; ++i) {
    views.push_back(photo(true_camera(i)));
    views.back().match.camera = disturbed(true_camera(i), degrees, shift, random);
    views.back().test = i >= count - tests;
  }
  return views;
}

/// Mean angle between the relative rotations of all pairs and the true ones, degrees: no common frame is needed.
inline double pair_error(const std::vector<Camera>& cameras) {
  double sum = 0;
  int pairs = 0;
  for (size_t i = 0; i < cameras.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const Mat3d got = cameras[i].world_to_camera.rotation * transpose(cameras[j].world_to_camera.rotation);
      const Mat3d want = true_camera(static_cast<int>(i)).world_to_camera.rotation *
                         transpose(true_camera(static_cast<int>(j)).world_to_camera.rotation);
      const Mat3d d = got * transpose(want);
      sum += std::acos(std::min(1.0, 0.5 * (d(0, 0) + d(1, 1) + d(2, 2) - 1))) * 180 / kPi;
      ++pairs;
    }
  }
  return pairs == 0 ? 0 : sum / pairs;
}

}  // namespace aligngs::wall_photos
