// Nearest neighbours in a set of points.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/thread_pool.h"
#include "core/vec.h"

namespace aligngs {

/// index is kNoPoint and distance infinite when the set is empty or the query is not finite.
struct Nearest {
  static constexpr uint32_t kNoPoint = 0xffffffffu;
  uint32_t index = kNoPoint;
  float distance = 0;
};

/// A kd-tree (nanoflann) over a copy of the points.
class PointIndex {
 public:
  explicit PointIndex(std::vector<Vec3f> points);
  ~PointIndex();
  PointIndex(PointIndex&&) noexcept;
  PointIndex& operator=(PointIndex&&) noexcept;

  const std::vector<Vec3f>& points() const;
  Nearest nearest(const Vec3f& query) const;
  std::vector<Nearest> nearest(const std::vector<Vec3f>& queries, ThreadPool& pool) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace aligngs
