#include "mesh/normal_smoothing.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mesh/fusion_frame.h"

namespace aligngs {
namespace {

constexpr double kLeastCosine = 0.1;  // of ray and normal: flatter, a step along the tangent plane has no bound
constexpr double kConverged = 1e-10;  // squared residual relative to the first one

/// Between every pixel and its neighbour to one side: how much deeper, in log depth, the normals have the pixel, and
/// how much that counts.
struct Bonds {
  int dx = 0, dy = 0;
  std::vector<double> step, weight;
  std::vector<uint8_t> there;  ///< both pixels have depth and normal
};

class Smoother {
 public:
  Smoother(const ImageF& depth, const ImageF& normal, const ImageF& weight, const Camera& camera,
           const NormalSmoothingOptions& options)
      : options_(options), camera_(camera), normal_(normal), width_(depth.width), height_(depth.height) {
    const size_t pixels = depth.data.size();
    known_.assign(pixels, 0);
    start_.assign(pixels, 0);
    own_.assign(pixels, 0);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const float z = valid_depth(depth, x, y);
        if (z == 0) continue;
        const size_t i = index(x, y);
        known_[i] = 1;
        start_[i] = std::log(static_cast<double>(z));
        own_[i] = weight.empty() ? 1.0 : std::max(0.0, static_cast<double>(weight.at(x, y)));
      }
    }
    right_ = bonds(1, 0);
    down_ = bonds(0, 1);
  }

  ImageF run() {
    std::vector<double> l = start_;
    for (int round = 0; round < options_.rounds; ++round) {
      weigh(right_, l);
      weigh(down_, l);
      std::vector<double> own = own_;
      for (size_t i = 0; i < own.size(); ++i) {
        const double off = std::abs(l[i] - start_[i]);
        if (off > options_.outlier) own[i] *= options_.outlier / off;
      }
      solve(own, l);
    }
    ImageF out(width_, height_, 1);
    for (size_t i = 0; i < l.size(); ++i) out.data[i] = known_[i] ? static_cast<float>(std::exp(l[i])) : 0.0f;
    return out;
  }

 private:
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }

  /// -n . r of the pixel's normal and a ray; 0 where that is too flat or there is no normal.
  double facing(int x, int y, const Vec3d& ray) const {
    const float* n = normal_.pixel(x, y);
    const Vec3d v{n[0], n[1], n[2]};
    const double value = -dot(v, ray);
    return value > kLeastCosine * norm(v) * norm(ray) && std::isfinite(value) ? value : 0;
  }

  Bonds bonds(int dx, int dy) const {
    Bonds out{dx, dy, std::vector<double>(known_.size(), 0), std::vector<double>(known_.size(), 0),
              std::vector<uint8_t>(known_.size(), 0)};
    for (int y = 0; y + dy < height_; ++y) {
      for (int x = 0; x + dx < width_; ++x) {
        const size_t i = index(x, y);
        if (!known_[i] || !known_[index(x + dx, y + dy)]) continue;
        const Vec3d own = camera_.ray(x + 0.5, y + 0.5), other = camera_.ray(x + dx + 0.5, y + dy + 0.5),
                    border = (own + other) * 0.5;
        const double a = facing(x, y, own), a_border = facing(x, y, border);
        const double b = facing(x + dx, y + dy, other), b_border = facing(x + dx, y + dy, border);
        if (a == 0 || a_border == 0 || b == 0 || b_border == 0) continue;
        out.there[i] = 1;
        // on a plane z is inversely proportional to n . r
        out.step[i] = std::log(b / b_border) - std::log(a / a_border);
      }
    }
    return out;
  }

  /// Tukey's biweight of how far the present step is from that of the normals.
  void weigh(Bonds& bonds, const std::vector<double>& l) const {
    const double strength = options_.length * options_.length;
    for (int y = 0; y + bonds.dy < height_; ++y) {
      for (int x = 0; x + bonds.dx < width_; ++x) {
        const size_t i = index(x, y);
        if (!bonds.there[i]) continue;
        const double share = (l[i] - l[index(x + bonds.dx, y + bonds.dy)] - bonds.step[i]) / options_.jump;
        const double left = std::max(0.0, 1 - share * share);
        bonds.weight[i] = strength * left * left;
      }
    }
  }

  /// out += the matrix of the bonds times v; `constant`: out += its right-hand side instead.
  void add_bonds(const Bonds& bonds, const std::vector<double>* v, std::vector<double>& out) const {
    for (int y = 0; y + bonds.dy < height_; ++y) {
      for (int x = 0; x + bonds.dx < width_; ++x) {
        const size_t i = index(x, y), j = index(x + bonds.dx, y + bonds.dy);
        const double pull = bonds.weight[i] * (v ? (*v)[i] - (*v)[j] : bonds.step[i]);
        out[i] += pull;
        out[j] -= pull;
      }
    }
  }

  std::vector<double> times(const std::vector<double>& own, const std::vector<double>& v) const {
    std::vector<double> out(v.size());
    for (size_t i = 0; i < v.size(); ++i) out[i] = own[i] * v[i];
    add_bonds(right_, &v, out);
    add_bonds(down_, &v, out);
    return out;
  }

  /// Conjugate gradients with the diagonal as preconditioner, from l on. Pixels without weight and bonds stay.
  void solve(const std::vector<double>& own, std::vector<double>& l) const {
    const size_t n = l.size();
    std::vector<double> residual(n), diagonal(own);
    for (size_t i = 0; i < n; ++i) residual[i] = own[i] * start_[i];
    add_bonds(right_, nullptr, residual);
    add_bonds(down_, nullptr, residual);
    for (const Bonds* bonds : {&right_, &down_}) {
      for (int y = 0; y + bonds->dy < height_; ++y) {
        for (int x = 0; x + bonds->dx < width_; ++x) {
          diagonal[index(x, y)] += bonds->weight[index(x, y)];
          diagonal[index(x + bonds->dx, y + bonds->dy)] += bonds->weight[index(x, y)];
        }
      }
    }
    const std::vector<double> present = times(own, l);
    std::vector<double> scaled(n, 0), direction(n, 0);
    double product = 0;
    for (size_t i = 0; i < n; ++i) {
      residual[i] -= present[i];
      scaled[i] = diagonal[i] > 0 ? residual[i] / diagonal[i] : 0;
      direction[i] = scaled[i];
      product += residual[i] * scaled[i];
    }
    const double enough = kConverged * product;
    for (int iteration = 0; iteration < options_.iterations && product > enough; ++iteration) {
      const std::vector<double> image = times(own, direction);
      double curvature = 0;
      for (size_t i = 0; i < n; ++i) curvature += direction[i] * image[i];
      if (!(curvature > 0)) return;
      const double step = product / curvature;
      double next = 0;
      for (size_t i = 0; i < n; ++i) {
        l[i] += step * direction[i];
        residual[i] -= step * image[i];
        scaled[i] = diagonal[i] > 0 ? residual[i] / diagonal[i] : 0;
        next += residual[i] * scaled[i];
      }
      for (size_t i = 0; i < n; ++i) direction[i] = scaled[i] + next / product * direction[i];
      product = next;
    }
  }

  const NormalSmoothingOptions& options_;
  const Camera& camera_;
  const ImageF& normal_;
  int width_, height_;
  std::vector<uint8_t> known_;
  std::vector<double> start_, own_;  // log depth and its weight
  Bonds right_, down_;
};

}  // namespace

ImageF smooth_along_normals(const ImageF& depth, const ImageF& normal, const ImageF& weight, const Camera& camera,
                            const NormalSmoothingOptions& options) {
  if (depth.empty() || !(options.length > 0)) return depth;
  return Smoother(depth, normal, weight, camera, options).run();
}

}  // namespace aligngs
