// The normal equations of a bundle adjustment: points eliminated (Schur complement), cameras solved for together.
#pragma once

#include <optional>
#include <vector>

#include "core/thread_pool.h"
#include "refine/bundle_adjustment.h"
#include "refine/bundle_points.h"
#include "refine/bundle_terms.h"

namespace aligngs {

/// A step of all numbers, and how much the linearised cost falls by it.
struct BundleStep {
  std::vector<Lanes> views;  ///< by ViewLane; every view has the shared focal length's
  std::vector<Vec3d> points;
  double decrease = 0;
};

/// Terms, priors and unknowns of one problem. Sums are formed in the same order for any number of threads.
class BundleSystem {
 public:
  /// All outlive it. Observations of points behind their camera are left out.
  BundleSystem(const BundleProblem& problem, const BundleSettings& settings, ThreadPool& pool);

  /// Numbers in the problem of the views with observations: those of states and steps, in this order. Others change no
  /// bit of the result.
  const std::vector<size_t>& views() const { return views_; }
  BundleState start() const;
  /// Infinite where a point lies behind a camera that sees it.
  double cost(const BundleState& at) const;
  /// Levenberg-Marquardt: the diagonal of the normal equations grows by 1 / radius of itself. Nothing if the equations
  /// have no solution.
  std::optional<BundleStep> step(const BundleState& at, double radius) const;
  /// `at` after a step.
  BundleState moved(const BundleState& at, const BundleStep& step) const;

 private:
  void take_terms();
  void share_out();
  /// visit(view, lane, error, sigma) for every number that a prior holds.
  template <class Visit>
  void for_priors(const BundleState& at, const Visit& visit) const;

  const BundleProblem& problem_;
  const BundleSettings& settings_;
  ThreadPool& pool_;
  std::vector<size_t> views_;
  std::vector<BundleTerm> terms_;  ///< by point
  std::vector<size_t> first_;      ///< term of each point, and the end
  std::vector<size_t> chunks_;     ///< first points of the shares of work, and the end
  std::vector<Lanes> unknown_;     ///< 1 for the lanes of a view that are solved for, else 0
};

}  // namespace aligngs
