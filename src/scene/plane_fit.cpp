#include "scene/plane_fit.h"

#include <Eigen/Dense>

namespace aligngs {

PlaneFit fit_plane(const std::vector<Vec3d>& points, const std::vector<double>& weights, const Vec3d& towards,
                   double hold) {
  const auto weight = [&](size_t i) { return weights.empty() ? 1.0 : weights[i]; };
  const auto vector = [](const Vec3d& v) { return Eigen::Vector3d(v.x, v.y, v.z); };
  double sum = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < points.size(); ++i) {
    sum += weight(i);
    mean += weight(i) * vector(points[i]);
  }
  mean /= sum;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d d = vector(points[i]) - mean;
    scatter += weight(i) * d * d.transpose();
  }
  const Eigen::Vector3d held = vector(towards);
  scatter += hold * (Eigen::Matrix3d::Identity() - held * held.transpose());
  const Eigen::Vector3d n = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  const Vec3d normal{n.x(), n.y(), n.z()};
  return {dot(normal, towards) < 0 ? -normal : normal, {mean.x(), mean.y(), mean.z()}};
}

}  // namespace aligngs
