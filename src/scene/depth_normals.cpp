#include "scene/depth_normals.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "core/error.h"
#include "core/is_depth.h"
#include "core/target_clones.h"
#include "core/vector_lanes.h"

namespace aligngs {
namespace {

/// Weighted sums of a regression 1 / z = c + a u + b v over a window; u, v are offsets from the centre's ray.
template <class Number>
struct Sums {
  Number w{}, u{}, v{}, q{}, uu{}, uv{}, vv{}, uq{}, vq{}, samples{};
};

/// The normal n / d of the plane at the ray (u0, v0, 1), or zero when the samples lie on a line.
Vec3d plane(const Sums<double>& s, double u0, double v0) {
  const double mu = s.u / s.w, mv = s.v / s.w, mq = s.q / s.w;
  const double suu = s.uu / s.w - mu * mu, suv = s.uv / s.w - mu * mv, svv = s.vv / s.w - mv * mv;
  const double suq = s.uq / s.w - mu * mq, svq = s.vq / s.w - mv * mq;
  const double determinant = suu * svv - suv * suv;
  // 1e-6 of the largest possible value: samples on one line are ~1e-16, the thinnest L shape is > 1e-3.
  if (!(determinant > 1e-6 * (suu + svv) * (suu + svv))) return {};
  const double a = (suq * svv - svq * suv) / determinant;
  const double b = (svq * suu - suq * suv) / determinant;
  const double c = mq - a * mu - b * mv;
  return {a, b, c - a * u0 - b * v0};
}

/// The largest float that is not above x.
float float_at_most(double x) {
  const float nearest = static_cast<float>(x);
  return nearest > x ? std::nextafter(nearest, -std::numeric_limits<float>::infinity()) : nearest;
}

/// A depth map with a border of zeros, so that windows of eight pixels side by side need no limits.
struct PaddedDepth {
  int border = 0;
  size_t stride = 0;
  std::vector<float> depth;             ///< 0: no value
  std::vector<float> most;              ///< the largest difference of a sample from the centre
  std::vector<double> inverse, weight;  ///< 1 / z and z^2; 1 where there is no value

  PaddedDepth(const ImageF& map, int radius, double jump)
      : border(radius), stride(static_cast<size_t>(map.width + 2 * radius + kLanes)) {
    const size_t count = stride * static_cast<size_t>(map.height + 2 * radius);
    depth.assign(count, 0.0f);
    most.assign(count, 0.0f);
    inverse.assign(count, 1.0);
    weight.assign(count, 1.0);
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x) {
        const float z = map.at(x, y);
        if (!is_depth(z)) continue;
        const size_t i = index(x, y);
        depth[i] = z;
        most[i] = float_at_most(jump * z);
        inverse[i] = 1.0 / z;
        weight[i] = 1 / (inverse[i] * inverse[i]);
      }
    }
  }

  size_t index(int x, int y) const {
    return static_cast<size_t>(y + border) * stride + static_cast<size_t>(x + border);
  }
};

/// The place of a sample in a window.
struct Offset {
  double u, v;  ///< from the centre's ray
  ptrdiff_t step;
};

/// Sums of the windows around eight pixels from `centre` on.
ALIGNGS_TARGET_CLONES
void sum_windows(const PaddedDepth& map, size_t centre, const Offset* offsets, size_t count, Sums<Lanes>& out) {
  Sums<DoubleLanes> sums;
  const FloatLanes none{}, one = none + 1;
  FloatLanes z, most;
  std::memcpy(&z, &map.depth[centre], sizeof(z));
  std::memcpy(&most, &map.most[centre], sizeof(most));
  for (size_t k = 0; k < count; ++k) {
    const Offset& offset = offsets[k];
    const size_t at = static_cast<size_t>(static_cast<ptrdiff_t>(centre) + offset.step);
    FloatLanes sample;
    DoubleLanes inverse, weight;
    std::memcpy(&sample, &map.depth[at], sizeof(sample));
    std::memcpy(&inverse, &map.inverse[at], sizeof(inverse));
    std::memcpy(&weight, &map.weight[at], sizeof(weight));
    FloatLanes difference = sample - z;
    difference = difference < none ? -difference : difference;
    // A factor, because GCC 12 takes comparisons of eight doubles apart.
    FloatLanes used = difference <= most ? one : none;
    used = sample > none ? used : none;
    const DoubleLanes counted = doubles_of(used);
    const DoubleLanes w = counted * weight;
    const DoubleLanes wu = w * offset.u, wv = w * offset.v;
    sums.w += w;
    sums.u += wu;
    sums.v += wv;
    sums.q += w * inverse;
    sums.uu += wu * offset.u;
    sums.uv += wu * offset.v;
    sums.vv += wv * offset.v;
    sums.uq += wu * inverse;
    sums.vq += wv * inverse;
    sums.samples += counted;
  }
  store(sums.w, out.w);
  store(sums.u, out.u);
  store(sums.v, out.v);
  store(sums.q, out.q);
  store(sums.uu, out.uu);
  store(sums.uv, out.uv);
  store(sums.vv, out.vv);
  store(sums.uq, out.uq);
  store(sums.vq, out.vq);
  store(sums.samples, out.samples);
}

Sums<double> lane_of(const Sums<Lanes>& s, int lane) {
  return {s.w[lane],  s.u[lane],  s.v[lane],  s.q[lane],  s.uu[lane],
          s.uv[lane], s.vv[lane], s.uq[lane], s.vq[lane], s.samples[lane]};
}

}  // namespace

ImageF camera_normals(const ImageF& depth, const Camera& camera, const DepthNormalOptions& options) {
  if (depth.width != camera.width || depth.height != camera.height) {
    throw Error({ErrorKind::kFailed, "a depth map must have the size of its camera", {}, "camera_normals", {}});
  }
  ImageF normals(depth.width, depth.height, 3);
  const PaddedDepth padded(depth, options.radius, options.jump);
  std::vector<Offset> offsets;
  for (int j = -options.radius; j <= options.radius; ++j) {
    for (int i = -options.radius; i <= options.radius; ++i)
      offsets.push_back({i / camera.fx, j / camera.fy, j * static_cast<ptrdiff_t>(padded.stride) + i});
  }
  Sums<Lanes> sums;
  for (int y = 0; y < depth.height; ++y) {
    for (int x0 = 0; x0 < depth.width; x0 += kLanes) {
      sum_windows(padded, padded.index(x0, y), offsets.data(), offsets.size(), sums);
      for (int x = x0; x < std::min(x0 + kLanes, depth.width); ++x) {
        if (padded.depth[padded.index(x, y)] == 0) continue;
        const Sums<double> fit = lane_of(sums, x - x0);
        if (fit.samples < options.min_samples) continue;
        const Vec3d ray = camera.ray(x + 0.5, y + 0.5);
        const Vec3d fitted = plane(fit, ray.x, ray.y);
        const double facing = dot(fitted, ray);  // 1 / z of the fitted plane at the centre: positive
        if (!(facing > 0)) continue;
        const Vec3d n = normalized(-fitted);
        for (int k = 0; k < 3; ++k) normals.at(x, y, k) = static_cast<float>(n[k]);
      }
    }
  }
  return normals;
}

}  // namespace aligngs
