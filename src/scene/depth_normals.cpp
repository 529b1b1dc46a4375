#include "scene/depth_normals.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/is_depth.h"

namespace aligngs {
namespace {

/// Weighted sums of a regression 1 / z = c + a u + b v over a window; u, v are offsets from the centre's ray.
struct Regression {
  double w = 0, u = 0, v = 0, q = 0, uu = 0, uv = 0, vv = 0, uq = 0, vq = 0;
  int samples = 0;

  void add(double du, double dv, double inverse_depth) {
    const double weight = 1 / (inverse_depth * inverse_depth);
    w += weight;
    u += weight * du;
    v += weight * dv;
    q += weight * inverse_depth;
    uu += weight * du * du;
    uv += weight * du * dv;
    vv += weight * dv * dv;
    uq += weight * du * inverse_depth;
    vq += weight * dv * inverse_depth;
    ++samples;
  }

  /// The normal n / d of the plane at the ray (u0, v0, 1), or zero when the samples lie on a line.
  Vec3d plane(double u0, double v0) const {
    const double mu = u / w, mv = v / w, mq = q / w;
    const double suu = uu / w - mu * mu, suv = uv / w - mu * mv, svv = vv / w - mv * mv;
    const double suq = uq / w - mu * mq, svq = vq / w - mv * mq;
    const double determinant = suu * svv - suv * suv;
    // 1e-6 of the largest possible value: samples on one line are ~1e-16, the thinnest L shape is > 1e-3.
    if (!(determinant > 1e-6 * (suu + svv) * (suu + svv))) return {};
    const double a = (suq * svv - svq * suv) / determinant;
    const double b = (svq * suu - suq * suv) / determinant;
    const double c = mq - a * mu - b * mv;
    return {a, b, c - a * u0 - b * v0};
  }
};

}  // namespace

ImageF camera_normals(const ImageF& depth, const Camera& camera, const DepthNormalOptions& options) {
  if (depth.width != camera.width || depth.height != camera.height) {
    throw Error({ErrorKind::kFailed, "a depth map must have the size of its camera", {}, "camera_normals", {}});
  }
  ImageF normals(depth.width, depth.height, 3);
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const float z = depth.at(x, y);
      if (!is_depth(z)) continue;
      const int x0 = std::max(0, x - options.radius), x1 = std::min(depth.width - 1, x + options.radius);
      const int y0 = std::max(0, y - options.radius), y1 = std::min(depth.height - 1, y + options.radius);
      Regression fit;
      for (int j = y0; j <= y1; ++j) {
        for (int i = x0; i <= x1; ++i) {
          const float sample = depth.at(i, j);
          if (!is_depth(sample) || std::abs(sample - z) > options.jump * z) continue;
          fit.add((i - x) / camera.fx, (j - y) / camera.fy, 1.0 / sample);
        }
      }
      if (fit.samples < options.min_samples) continue;
      const Vec3d ray = camera.ray(x + 0.5, y + 0.5);
      const Vec3d plane = fit.plane(ray.x, ray.y);
      const double facing = dot(plane, ray);  // 1 / z of the fitted plane at the centre: positive
      if (!(facing > 0)) continue;
      const Vec3d n = normalized(-plane);
      for (int k = 0; k < 3; ++k) normals.at(x, y, k) = static_cast<float>(n[k]);
    }
  }
  return normals;
}

}  // namespace aligngs
