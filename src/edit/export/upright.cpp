#include "edit/export/upright.h"

#include <Eigen/Dense>
#include <cmath>

namespace aligngs {
namespace {

/// Real spherical harmonics of one degree under a rotation: f'(d) = f(R^T d). The matrix of the coefficients is found
/// by sampling the basis in many directions and solving for it. It is exact, as rotations keep the degree.
Eigen::MatrixXd harmonic_rotation(int degree, const Mat3d& rotation) {
  const int first = degree * degree, width = 2 * degree + 1, samples = 4 * width;
  Eigen::MatrixXd before(samples, width), after(samples, width);
  double basis[kShCoefficients];
  for (int s = 0; s < samples; ++s) {
    // Fibonacci points: well spread, so that the least-squares problem is well conditioned.
    const double z = 1 - (2.0 * s + 1) / samples, r = std::sqrt(1 - z * z), angle = 2.399963229728653 * s;
    const Vec3d d{r * std::cos(angle), r * std::sin(angle), z};
    sh_basis(degree, d, basis);
    for (int k = 0; k < width; ++k) after(s, k) = basis[first + k];
    sh_basis(degree, transpose_times(rotation, d), basis);
    for (int k = 0; k < width; ++k) before(s, k) = basis[first + k];
  }
  return after.colPivHouseholderQr().solve(before);
}

}  // namespace

Mat3d rotation_to_y_up(const std::optional<Vec3d>& up) {
  const Mat3d half_turn{{1, 0, 0, 0, -1, 0, 0, 0, -1}};
  if (!up) return half_turn;
  // First the half turn, then the shortest rotation of what is left: a room whose up is -y is only turned over.
  const Vec3d from = normalized(half_turn * *up), to{0, 1, 0};
  const Vec3d axis = cross(from, to);
  const double c = dot(from, to), s = norm(axis);
  if (s < 1e-12) return c > 0 ? half_turn : Mat3d::identity();
  const Quaterniond q = normalized(Quaterniond{1 + c, axis.x, axis.y, axis.z});
  return rotation_matrix(q) * half_turn;
}

std::array<double, 16> root_matrix(const Mat3d& rotation, const Vec3d& offset) {
  const Vec3d t = rotation * offset;
  std::array<double, 16> m{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) m[static_cast<size_t>(4 * r + c)] = rotation(r, c);
    m[static_cast<size_t>(4 * r + 3)] = t[r];
  }
  m[15] = 1;
  return m;
}

GaussianModel rotated(GaussianModel model, const Mat3d& rotation) {
  Eigen::MatrixXd turn[kMaxShDegree + 1];
  for (int degree = 1; degree <= kMaxShDegree; ++degree) turn[degree] = harmonic_rotation(degree, rotation);
  for (size_t i = 0; i < model.size(); ++i) {
    const Vec3d p = rotation * Vec3d{model.positions[3 * i], model.positions[3 * i + 1], model.positions[3 * i + 2]};
    for (int a = 0; a < 3; ++a) model.positions[3 * i + static_cast<size_t>(a)] = static_cast<float>(p[a]);
    float* r = &model.rotations[4 * i];
    const Quaterniond q = quaternion_of(rotation * rotation_matrix(normalized(Quaterniond{r[0], r[1], r[2], r[3]})));
    const float turned[4] = {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
                             static_cast<float>(q.z)};
    std::copy_n(turned, 4, r);
    float* target = &model.sh[size_t(3) * kShCoefficients * i];
    std::array<float, size_t(3) * kShCoefficients> sh;
    std::copy_n(target, sh.size(), sh.begin());
    for (int degree = 1; degree <= kMaxShDegree; ++degree) {
      const int first = degree * degree, width = 2 * degree + 1;
      for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < width; ++k) {
          double sum = 0;
          for (int j = 0; j < width; ++j) sum += turn[degree](k, j) * sh[static_cast<size_t>(3 * (first + j) + c)];
          target[3 * (first + k) + c] = static_cast<float>(sum);
        }
      }
    }
  }
  return model;
}

}  // namespace aligngs
