#include "metrics/point_index.h"

#include <cmath>
#include <limits>
#include <utility>

#include "scene/kd_tree.h"

namespace aligngs {

namespace {
constexpr size_t kQueryGrain = 2048;  // queries per chunk of work
}

struct PointIndex::Tree : KdTree<float> {
  using KdTree::KdTree;
};

PointIndex::PointIndex(std::vector<Vec3f> points) : tree_(std::make_unique<Tree>(std::move(points))) {}
PointIndex::~PointIndex() = default;
PointIndex::PointIndex(PointIndex&&) noexcept = default;
PointIndex& PointIndex::operator=(PointIndex&&) noexcept = default;

const std::vector<Vec3f>& PointIndex::points() const { return tree_->points(); }

Nearest PointIndex::nearest(const Vec3f& query) const {
  Nearest result;
  result.distance = std::numeric_limits<float>::infinity();
  if (!std::isfinite(query.x + query.y + query.z)) return result;
  uint32_t index = 0;
  float squared = 0;
  if (tree_->nearest(query, 1, &index, &squared) == 0) return result;
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
