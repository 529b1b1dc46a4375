#include "metrics/point_index.h"

#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <utility>

namespace aligngs {

struct PointIndex::Tree {
  std::vector<Vec3f> points;

  // The interface nanoflann asks of a data set.
  size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(size_t i, size_t axis) const { return points[i][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }

  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Tree>, Tree, 3, uint32_t>;
  std::unique_ptr<Index> index;
};

namespace {
constexpr size_t kLeafSize = 12;     // points; the usual optimum for 3-D
constexpr size_t kQueryGrain = 2048; // queries per chunk of work
}  // namespace

PointIndex::PointIndex(std::vector<Vec3f> points) : tree_(std::make_unique<Tree>()) {
  tree_->points = std::move(points);
  if (!tree_->points.empty()) {
    tree_->index = std::make_unique<Tree::Index>(3, *tree_, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize));
  }
}

PointIndex::~PointIndex() = default;
PointIndex::PointIndex(PointIndex&&) noexcept = default;
PointIndex& PointIndex::operator=(PointIndex&&) noexcept = default;

const std::vector<Vec3f>& PointIndex::points() const { return tree_->points; }

Nearest PointIndex::nearest(const Vec3f& query) const {
  Nearest result;
  result.distance = std::numeric_limits<float>::infinity();
  if (!tree_->index || !std::isfinite(query.x + query.y + query.z)) return result;
  uint32_t index = 0;
  float squared = 0;
  const float q[3] = {query.x, query.y, query.z};
  tree_->index->knnSearch(q, 1, &index, &squared);
  result.index = index;
  result.distance = std::sqrt(squared);
  return result;
}

std::vector<Nearest> PointIndex::nearest(const std::vector<Vec3f>& queries, ThreadPool& pool) const {
  std::vector<Nearest> results(queries.size());
  pool.parallel_for(queries.size(), kQueryGrain, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) results[i] = nearest(queries[i]);
  });
  return results;
}

}  // namespace aligngs
