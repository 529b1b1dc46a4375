// The kd-tree of nanoflann over points in space. A heavy header: for .cpp files only.
#pragma once

#include <cmath>
#include <nanoflann.hpp>
#include <utility>
#include <vector>

#include "core/vec.h"

namespace aligngs {

/// Over a copy of the points. Not movable: the index refers to them.
template <class Real>
class KdTree {
 public:
  explicit KdTree(std::vector<Vec3<Real>> points)
      : cloud_{std::move(points)}, index_(3, cloud_, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize)) {}
  KdTree(const KdTree&) = delete;
  KdTree& operator=(const KdTree&) = delete;

  const std::vector<Vec3<Real>>& points() const { return cloud_.points; }

  /// Up to k nearest points, nearest first, and their squared distances; the number found. The query must be finite.
  size_t nearest(const Vec3<Real>& query, size_t k, uint32_t* index, Real* squared) const {
    if (cloud_.points.empty()) return 0;
    const Real q[3] = {query.x, query.y, query.z};
    return index_.knnSearch(q, k, index, squared);
  }
  /// Whether a point is at most `distance` away, with distances rounded as the roots of squared ones are.
  bool any_within(const Vec3<Real>& query, double distance) const {
    if (cloud_.points.empty()) return false;
    const Real q[3] = {query.x, query.y, query.z};
    AnyWithin result{distance};
    index_.findNeighbors(result, q, nanoflann::SearchParams());
    return result.found;
  }
  /// All points with a squared distance below the given one, nearest first.
  void within(const Vec3<Real>& query, Real squared, std::vector<std::pair<uint32_t, Real>>& found) const {
    found.clear();
    if (cloud_.points.empty()) return;
    const Real q[3] = {query.x, query.y, query.z};
    index_.radiusSearch(q, squared, found, nanoflann::SearchParams());
  }

  /// The same in no order.
  void within_unordered(const Vec3<Real>& query, Real squared, std::vector<std::pair<uint32_t, Real>>& found) const {
    found.clear();
    if (cloud_.points.empty()) return;
    const Real q[3] = {query.x, query.y, query.z};
    constexpr int kUnused = 32;
    index_.radiusSearch(q, squared, found, nanoflann::SearchParams(kUnused, 0, false));
  }

 private:
  static constexpr size_t kLeafSize = 12;  // points; the usual optimum in three dimensions

  /// Interface of a data set for nanoflann.
  struct Cloud {
    std::vector<Vec3<Real>> points;
    size_t kdtree_get_point_count() const { return points.size(); }
    Real kdtree_get_pt(size_t i, size_t axis) const { return points[i][static_cast<int>(axis)]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  /// A result set for nanoflann that ends the search at the first point.
  struct AnyWithin {
    double distance;
    bool found = false;
    double worstDist() const { return distance * distance * (1 + 1e-5); }  // beyond the rounding of Real
    bool full() const { return found; }
    bool addPoint(Real squared, uint32_t) {
      found |= static_cast<double>(std::sqrt(squared)) <= distance;
      return !found;
    }
  };
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<Real, Cloud>, Cloud, 3, uint32_t>;

  Cloud cloud_;
  Index index_;
};

}  // namespace aligngs
