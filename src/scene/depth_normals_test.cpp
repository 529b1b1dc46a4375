#include "scene/depth_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/is_depth.h"
#include "core/random.h"

namespace aligngs {
namespace {

Camera camera_of(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = width;
  camera.cx = width / 2.0;
  camera.cy = height / 2.0;
  return camera;
}

/// Depth of the plane n . X = d.
ImageF plane_depth(const Camera& camera, const Vec3d& n, double d) {
  ImageF depth(camera.width, camera.height, 1);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      depth.at(x, y) = static_cast<float>(d / dot(n, camera.ray(x + 0.5, y + 0.5)));
  return depth;
}

double angle_degrees(const ImageF& normals, int x, int y, const Vec3d& expected) {
  const Vec3d n{normals.at(x, y, 0), normals.at(x, y, 1), normals.at(x, y, 2)};
  return std::atan2(norm(cross(n, expected)), dot(n, expected)) * 180 / 3.14159265358979;
}

TEST(DepthNormals, ASlantedPlaneHasItsNormalTurnedToTheCamera) {
  const Camera camera = camera_of(20, 16);
  const Vec3d n = normalized(Vec3d{0.3, -0.4, 1});
  const ImageF normals = camera_normals(plane_depth(camera, n, 2), camera);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 20; ++x) ASSERT_LT(angle_degrees(normals, x, y, -n), 0.05) << x << ", " << y;
}

TEST(DepthNormals, NoiseTurnsTheNormalByFewDegrees) {
  const Camera camera = camera_of(32, 32);
  ImageF depth = plane_depth(camera, {0, 0, 1}, 2);
  Random random(3);
  for (float& z : depth.data) z *= static_cast<float>(1 + 0.003 * random.normal());
  DepthNormalOptions wide;
  wide.radius = 4;
  EXPECT_LT(angle_degrees(camera_normals(depth, camera, wide), 16, 16, {0, 0, -1}), 5);
}

TEST(DepthNormals, ADepthStepDoesNotTiltTheNormalsBesideIt) {
  const Camera camera = camera_of(20, 20);
  ImageF depth(20, 20, 1, 2.0f);
  for (int y = 0; y < 20; ++y)
    for (int x = 10; x < 20; ++x) depth.at(x, y) = 3;
  const ImageF normals = camera_normals(depth, camera);
  EXPECT_LT(angle_degrees(normals, 9, 10, {0, 0, -1}), 1e-3);
  EXPECT_LT(angle_degrees(normals, 10, 10, {0, 0, -1}), 1e-3);
}

TEST(DepthNormals, WithoutEnoughSamplesThereIsNoNormal) {
  const Camera camera = camera_of(8, 8);
  ImageF depth(8, 8, 1);
  for (int x = 0; x < 8; ++x) depth.at(x, 4) = 1;  // a line determines no plane
  depth.at(0, 0) = std::numeric_limits<float>::quiet_NaN();
  DepthNormalOptions options;
  options.min_samples = 2;
  for (float value : camera_normals(depth, camera, options).data) ASSERT_EQ(value, 0);
}

/// The oracle: the regression of one pixel, sample by sample.
Vec3d fitted_normal(const ImageF& depth, const Camera& camera, int x, int y, const DepthNormalOptions& options) {
  const float z = depth.at(x, y);
  double w = 0, u = 0, v = 0, q = 0, uu = 0, uv = 0, vv = 0, uq = 0, vq = 0;
  int samples = 0;
  for (int j = std::max(0, y - options.radius); j <= std::min(depth.height - 1, y + options.radius); ++j) {
    for (int i = std::max(0, x - options.radius); i <= std::min(depth.width - 1, x + options.radius); ++i) {
      const float sample = depth.at(i, j);
      if (!is_depth(sample) || std::abs(sample - z) > options.jump * z) continue;
      const double du = (i - x) / camera.fx, dv = (j - y) / camera.fy, inverse = 1.0 / sample;
      const double weight = 1 / (inverse * inverse);
      w += weight, u += weight * du, v += weight * dv, q += weight * inverse;
      uu += weight * du * du, uv += weight * du * dv, vv += weight * dv * dv;
      uq += weight * du * inverse, vq += weight * dv * inverse;
      ++samples;
    }
  }
  if (!is_depth(z) || samples < options.min_samples) return {};
  u /= w, v /= w, q /= w, uu = uu / w - u * u, uv = uv / w - u * v, vv = vv / w - v * v;
  uq = uq / w - u * q, vq = vq / w - v * q;
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 1e-6 * (uu + vv) * (uu + vv))) return {};
  const double a = (uq * vv - vq * uv) / determinant, b = (vq * uu - uq * uv) / determinant;
  const Vec3d ray = camera.ray(x + 0.5, y + 0.5), plane{a, b, q - a * u - b * v - a * ray.x - b * ray.y};
  return dot(plane, ray) > 0 ? normalized(-plane) : Vec3d{};
}

TEST(DepthNormals, EightPixelsAtOnceHaveTheNormalsOfTheScalarFit) {
  for (const int width : {1, 7, 8, 9, 29}) {
    const Camera camera = camera_of(width, 11);
    ImageF depth(width, 11, 1);
    Random random(static_cast<uint64_t>(width));
    for (size_t i = 0; i < depth.data.size(); ++i) {
      const bool absent = random.uniform() < 0.1;
      depth.data[i] = absent ? (i % 2 ? 0.0f : std::numeric_limits<float>::quiet_NaN())
                             : static_cast<float>(2 + 0.2 * random.uniform());
    }
    for (const int radius : {1, 2, 4}) {
      DepthNormalOptions options;
      options.radius = radius;
      const ImageF normals = camera_normals(depth, camera, options);
      for (int y = 0; y < 11; ++y) {
        for (int x = 0; x < width; ++x) {
          const Vec3d expected = fitted_normal(depth, camera, x, y, options);
          for (int k = 0; k < 3; ++k)
            ASSERT_EQ(normals.at(x, y, k), static_cast<float>(expected[k])) << width << ": " << x << ", " << y;
        }
      }
    }
  }
}

TEST(DepthNormals, AMapOfAnotherSizeIsRefused) {
  EXPECT_THROW(camera_normals(ImageF(4, 4, 1, 1.0f), camera_of(8, 8)), Error);
}

}  // namespace
}  // namespace aligngs
