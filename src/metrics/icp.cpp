#include "metrics/icp.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/point_index.h"

namespace aligngs {
namespace {

// Eigenvalues of the normal equations below this share of the largest mark directions that the surface leaves open. An
// example is a wall that is flat to 1 % of its width. A room with 1 % of its area across has a hundred times as much.
constexpr double kRelativeRank = 1e-4;
constexpr double kConverged = 1e-6;  // step, as a share of the cloud's size: a micrometre per metre
constexpr size_t kMinPairs = 7;      // unknowns of a similarity

using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

struct Pairs {
  Matrix7 normal = Matrix7::Zero();
  Vector7 gradient = Vector7::Zero();
  double squared = 0;
  size_t count = 0;
  double rmse() const {
    return count ? std::sqrt(squared / static_cast<double>(count)) : std::numeric_limits<double>::quiet_NaN();
  }
};

Mat3d rotation_of(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
  if (angle > 0) m = Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
  Mat3d r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = m(i, j);
  return r;
}

/// Solves for the step along the well determined directions only.
Vector7 solve(const Pairs& pairs, bool with_scale) {
  Matrix7 normal = pairs.normal;
  Vector7 gradient = pairs.gradient;
  if (!with_scale) {
    normal.row(6).setZero();
    normal.col(6).setZero();
    gradient(6) = 0;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix7> eigen(normal);
  const double floor = kRelativeRank * eigen.eigenvalues()(6);
  Vector7 step = Vector7::Zero();
  for (int i = 0; i < 7; ++i) {
    const double value = eigen.eigenvalues()(i);
    if (value <= floor || value <= 0) continue;
    step -= eigen.eigenvectors().col(i) * (eigen.eigenvectors().col(i).dot(gradient) / value);
  }
  return step;
}

class Icp {
 public:
  Icp(const std::vector<Vec3f>& source, const PointSet& target, ThreadPool& pool, const IcpOptions& options)
      : target_(target), index_(target.positions), pool_(pool), options_(options) {
    const size_t stride = std::max<size_t>(1, (source.size() + options.max_points - 1) / options.max_points);
    for (size_t i = 0; i < source.size(); i += stride) {
      source_.push_back(source[i].cast<double>());
      centre_ += source_.back();
    }
    if (source_.empty()) return;
    centre_ *= 1.0 / static_cast<double>(source_.size());
    for (const Vec3d& p : source_) size_ += dot(p - centre_, p - centre_);
    size_ = std::sqrt(size_ / static_cast<double>(source_.size()));
    if (!(size_ > 0)) size_ = 1;
  }

  IcpReport run() {
    IcpReport report;
    if (options_.distances.empty() || source_.empty()) return report;
    report.rmse_before = pair_up(report.similarity, options_.distances.back()).rmse();
    for (const double distance : options_.distances) report.converged = run_stage(distance, report);
    const Pairs final = pair_up(report.similarity, options_.distances.back());
    report.rmse_after = final.rmse();
    report.inliers = static_cast<double>(final.count) / static_cast<double>(source_.size());
    return report;
  }

 private:
  bool run_stage(double distance, IcpReport& report) {
    for (int i = 0; i < options_.iterations; ++i) {
      const Pairs pairs = pair_up(report.similarity, distance);
      if (pairs.count < kMinPairs) return false;
      const Vector7 step = solve(pairs, options_.with_scale);
      apply(step, report.similarity);
      ++report.iterations;
      if (step.cwiseAbs().maxCoeff() < kConverged) return true;
    }
    return false;
  }

  /// Unknowns: rotation, translation / size and log scale, about the moved centre of the source.
  Pairs pair_up(const Similarity& similarity, double distance) {
    std::vector<Vec3f> moved(source_.size());
    for (size_t i = 0; i < source_.size(); ++i) moved[i] = (similarity * source_[i]).cast<float>();
    const std::vector<Nearest> nearest = index_.nearest(moved, pool_);
    const Vec3d centre = similarity * centre_;
    Pairs pairs;
    for (size_t i = 0; i < moved.size(); ++i) {
      if (!(nearest[i].distance < distance)) continue;
      const Vec3d n = target_.normals[nearest[i].index].cast<double>();
      const Vec3d q = target_.positions[nearest[i].index].cast<double>();
      const Vec3d x = moved[i].cast<double>();
      const Vec3d p = (x - centre) * (1 / size_);
      const Vec3d turn = cross(p, n);
      const double residual = dot(n, x - q);
      Vector7 row;
      row << turn.x, turn.y, turn.z, n.x, n.y, n.z, dot(p, n);
      pairs.normal += row * row.transpose();
      pairs.gradient += row * (residual / size_);
      pairs.squared += residual * residual;
      ++pairs.count;
    }
    return pairs;
  }

  void apply(const Vector7& step, Similarity& similarity) const {
    const Vec3d centre = similarity * centre_;
    const Mat3d rotation = rotation_of(step.head<3>());
    const double scale = std::exp(step(6));
    const Vec3d shift = Vec3d{step(3), step(4), step(5)} * size_;
    // x -> centre + scale R (x - centre) + shift, after what was there before.
    similarity.translation = centre + scale * (rotation * (similarity.translation - centre)) + shift;
    similarity.rotation = rotation * similarity.rotation;
    similarity.scale *= scale;
  }

  std::vector<Vec3d> source_;
  const PointSet& target_;
  PointIndex index_;
  ThreadPool& pool_;
  const IcpOptions& options_;
  Vec3d centre_;
  double size_ = 0;
};

}  // namespace

IcpReport align_by_icp(const std::vector<Vec3f>& source, const PointSet& target, ThreadPool& pool,
                       const IcpOptions& options) {
  return Icp(source, target, pool, options).run();
}

}  // namespace aligngs
