#include "core/rigid.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/angles.h"

namespace aligngs {
namespace {

Eigen::Vector3d to_eigen(const Vec3d& v) { return {v.x, v.y, v.z}; }

Mat3d from_eigen(const Eigen::Matrix3d& m) {
  Mat3d r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = m(i, j);
  return r;
}

/// The rotation nearest to m in the Frobenius norm.
Mat3d nearest_rotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return from_eigen(svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose());
}

Vec3d mean_of(const std::vector<Vec3d>& points) {
  Vec3d mean;
  for (const Vec3d& p : points) mean += p;
  return points.empty() ? mean : mean * (1.0 / static_cast<double>(points.size()));
}

void set_translation_and_rmse(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to, SimilarityFit& fit) {
  Similarity& s = fit.similarity;
  s.translation = mean_of(to) - s.scale * (s.rotation * mean_of(from));
  double sum = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    const Vec3d d = s * from[i] - to[i];
    sum += dot(d, d);
  }
  fit.rmse = from.empty() ? 0 : std::sqrt(sum / static_cast<double>(from.size()));
}

}  // namespace

Similarity Similarity::inverse() const {
  Similarity r;
  r.scale = 1 / scale;
  r.rotation = transpose(rotation);
  r.translation = -(r.scale * (r.rotation * translation));
  return r;
}

Rigidd Similarity::transform_world_to_camera(const Rigidd& world_to_camera) const {
  // y = s R x + t, so x = R^T (y - t) / s; camera coordinates are scaled by s to keep depth in new units.
  Rigidd r;
  r.rotation = world_to_camera.rotation * transpose(rotation);
  r.translation = scale * world_to_camera.translation - r.rotation * translation;
  return r;
}

SimilarityFit fit_similarity(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to, bool with_scale) {
  SimilarityFit fit;
  const size_t n = std::min(from.size(), to.size());
  if (n == 0) return fit;
  const Vec3d mean_from = mean_of(from), mean_to = mean_of(to);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double variance = 0;
  for (size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d a = to_eigen(from[i] - mean_from), b = to_eigen(to[i] - mean_to);
    covariance += b * a.transpose();
    variance += a.squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& d = svd.singularValues();
  fit.well_posed = n >= 3 && variance > 0 && d(1) > 1e-9 * d(0);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  fit.similarity.rotation = from_eigen(svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose());
  if (with_scale && variance > 0) fit.similarity.scale = d.dot(sign) / variance;
  if (!(fit.similarity.scale > 0)) fit.similarity.scale = 1;
  set_translation_and_rmse(from, to, fit);
  return fit;
}

SimilarityFit fit_similarity_of_cameras(const std::vector<Rigidd>& from, const std::vector<Rigidd>& to) {
  SimilarityFit fit;
  const size_t n = std::min(from.size(), to.size());
  if (n == 0) return fit;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  std::vector<Vec3d> a, b;
  for (size_t i = 0; i < n; ++i) {
    const Mat3d r = transpose(to[i].rotation) * from[i].rotation;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) sum(row, column) += r(row, column);
    a.push_back(from[i].inverse().translation);
    b.push_back(to[i].inverse().translation);
  }
  fit.similarity.rotation = nearest_rotation(sum);
  const Vec3d mean_a = mean_of(a), mean_b = mean_of(b);
  double numerator = 0, denominator = 0;
  for (size_t i = 0; i < n; ++i) {
    const Vec3d p = fit.similarity.rotation * (a[i] - mean_a);
    numerator += dot(p, b[i] - mean_b);
    denominator += dot(p, p);
  }
  fit.well_posed = n >= 2 && denominator > 0 && numerator > 0;
  if (fit.well_posed) fit.similarity.scale = numerator / denominator;
  set_translation_and_rmse(a, b, fit);
  return fit;
}

double rotation_angle_between_degrees(const Mat3d& a, const Mat3d& b) {
  // atan2 of both halves keeps small angles exact, where acos(trace) loses half the digits.
  const Mat3d r = a * transpose(b);
  const double cosine = (r(0, 0) + r(1, 1) + r(2, 2) - 1) / 2;
  const Vec3d axis{r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1)};
  return std::atan2(norm(axis) / 2, cosine) * 180.0 / kPi;
}

}  // namespace aligngs
