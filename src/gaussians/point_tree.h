// Several nearest points, or all within a radius; metrics/point_index.h answers the question for one.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/thread_pool.h"
#include "core/vec.h"

namespace aligngs {

/// A kd-tree (nanoflann) over a copy of some points. Answers are ordered by distance, then by index, so that they do
/// not depend on how the tree was built.
class PointTree {
 public:
  struct Neighbour {
    uint32_t index = 0;
    float distance = 0;
  };

  explicit PointTree(std::vector<Vec3f> points);
  ~PointTree();
  PointTree(PointTree&&) noexcept;

  size_t size() const;
  const Vec3f& point(size_t i) const;
  /// At most k neighbours of `query`; the point itself counts when it is in the tree.
  void nearest(const Vec3f& query, size_t k, std::vector<Neighbour>& out) const;
  /// Whether a point is at most `distance` away: the same as asking for the nearest one, and quicker.
  bool any_within(const Vec3f& query, double distance) const;
  /// All points with distance < radius; for trees of points that lie apart, as the answer may be all of them.
  void within(const Vec3f& query, float radius, std::vector<Neighbour>& out) const;
  /// Their numbers alone, in no order.
  void within_unordered(const Vec3f& query, float radius, std::vector<uint32_t>& out) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// The k nearest other points of every point: neighbours of i are at [k * i, k * i + k); where fewer exist the rest is
/// kNone with infinite distance.
struct NeighbourGraph {
  static constexpr uint32_t kNone = 0xffffffffu;
  size_t k = 0;
  std::vector<uint32_t> index;
  std::vector<float> distance;
};
NeighbourGraph neighbour_graph(const std::vector<Vec3f>& points, size_t k, ThreadPool& pool);
/// The same for some of the points: neighbours of the point rows[i] are at [k * i, k * i + k).
NeighbourGraph neighbour_graph(const std::vector<Vec3f>& points, const std::vector<uint32_t>& rows, size_t k,
                               ThreadPool& pool);
/// The same for some points of a tree, which answers several such questions.
NeighbourGraph neighbour_graph(const PointTree& tree, const std::vector<uint32_t>& rows, size_t k, ThreadPool& pool);

}  // namespace aligngs
