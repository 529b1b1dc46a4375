#include "synth/world_bend.h"

#include <cmath>

#include "core/angles.h"

namespace aligngs {
namespace {

Vec3d random_direction(Random& random) { return normalized(Vec3d{random.normal(), random.normal(), random.normal()}); }
}  // namespace

WorldBend::WorldBend(const WorldBendOptions& options, const Vec3d& centre, const Vec3d& up, Random& random)
    : centre_(centre) {
  mode_count_ = 4;
  // Each mode a_i sin(k.x + phase) has mean square a_i^2 / 2. Longer waves are stronger, in proportion: networks
  // see the whole room, their errors have little power at short range.
  double power = 0;
  for (Mode& mode : modes_) {
    const double wavelength = random.uniform(1.5, 4.0);  // metres
    mode.wave = random_direction(random) * (2 * kPi / wavelength);
    mode.direction = random_direction(random) * wavelength;
    mode.phase = random.uniform(0, 2 * kPi);
    power += wavelength * wavelength / 2;
  }
  for (Mode& mode : modes_) mode.direction *= options.rms / std::sqrt(power);
  const Vec3d r = random_direction(random);
  along_ = normalized(r - up * dot(r, up));
  side_ = cross(up, along_);
  curvature_ = options.bend_degrees * kPi / 180 / options.extent * (random.chance(0.5) ? 1 : -1);
}

Vec3d WorldBend::operator()(const Vec3d& x) const {
  Vec3d y = x;
  if (std::fabs(curvature_) > 1e-9) {
    const Vec3d q = x - centre_;
    const double s = dot(q, along_), t = dot(q, side_), radius = 1 / curvature_ - t, angle = curvature_ * s;
    y += along_ * (radius * std::sin(angle) - s) + side_ * (1 / curvature_ - radius * std::cos(angle) - t);
  }
  for (int i = 0; i < mode_count_; ++i) y += modes_[i].direction * std::sin(dot(modes_[i].wave, x) + modes_[i].phase);
  return y;
}

Mat3d WorldBend::jacobian(const Vec3d& x) const {
  constexpr double h = 1e-4;  // metres
  Mat3d j;
  for (int c = 0; c < 3; ++c) {
    Vec3d d;
    d[c] = h;
    const Vec3d column = ((*this)(x + d) - (*this)(x - d)) * (0.5 / h);
    for (int r = 0; r < 3; ++r) j(r, c) = column[r];
  }
  return j;
}

Mat3d WorldBend::rotation(const Vec3d& x) const {
  // Polar decomposition by Newton's iteration: Q <- (Q + Q^-T) / 2.
  Mat3d q = jacobian(x);
  for (int i = 0; i < 20; ++i) {
    const double det = determinant(q);
    const Vec3d a = q.row(0), b = q.row(1), c = q.row(2);
    const Vec3d rows[3] = {cross(b, c), cross(c, a), cross(a, b)};  // of the cofactor matrix: det * Q^-T
    for (int r = 0; r < 3; ++r) {
      for (int k = 0; k < 3; ++k) q(r, k) = 0.5 * (q(r, k) + rows[r][k] / det);
    }
  }
  return q;
}

}  // namespace aligngs
