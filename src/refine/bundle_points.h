// The part of a bundle adjustment that points have to themselves: each is eliminated from the equations of its views.
#pragma once

#include <vector>

#include "core/vector_lanes.h"
#include "refine/bundle_terms.h"

namespace aligngs {

/// Levenberg-Marquardt adds this to an element of the diagonal.
double bundle_damping(double diagonal, double radius);

/// Symmetric: xx, xy, xz, yy, yz, zz.
struct Symmetric3 {
  double m[6]{};
};

/// First of the kLanes rows of a pair of views in the lower triangle.
inline size_t block_of(size_t later, size_t earlier) { return (later * (later + 1) / 2 + earlier) * kLanes; }

/// Sums over a share of the points, for the normal equations J'WJ step = -J'Wr of the views.
struct ViewSums {
  std::vector<Lanes> blocks;    ///< rows of the lower triangle of views, points eliminated
  std::vector<Lanes> gradient;  ///< by view
  std::vector<Lanes> reduced;   ///< added to the gradient when points are eliminated
  std::vector<Lanes> diagonal;  ///< before points are eliminated
  bool in_front = true;         ///< no point lies behind its camera; else the sums are not complete

  explicit ViewSums(size_t views) : blocks(block_of(views, 0)), gradient(views), reduced(views), diagonal(views) {}
  void add(const ViewSums& other);
};

/// How a term ties its view to each axis of its point.
struct TermLink {
  Lanes by_axis[3];
};

/// A point's own, for its step.
struct PointEquations {
  Symmetric3 inverse;  ///< of its damped block; zeros if that is singular
  Vec3d gradient;
  Vec3d damping;
};

/// A share of the points and of the terms, which are in the order of the points.
struct PointShare {
  const BundleState& at;
  const std::vector<BundleTerm>& terms;
  const std::vector<size_t>& first;   ///< term of each point, and the end
  const std::vector<Lanes>& unknown;  ///< 1 for the lanes of a view that are solved for, else 0
  bool fixed_points;
  double radius;
  size_t begin, end;  ///< points
};

/// Adds the share's terms to `sums` and fills in `links`, by term, and `points`, unless they are fixed.
void eliminate_points(const PointShare& share, ViewSums& sums, TermLink* links, PointEquations* points);

/// Step of each point of the share once the views' is known. Their part of BundleStep::decrease.
double point_steps(const PointShare& share, const std::vector<Lanes>& views, const TermLink* links,
                   const PointEquations* points, Vec3d* steps);

}  // namespace aligngs
