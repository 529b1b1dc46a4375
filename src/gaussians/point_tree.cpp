#include "gaussians/point_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "scene/kd_tree.h"

namespace aligngs {
namespace {

constexpr size_t kQueryGrain = 1024;  // queries per chunk

bool nearer(const PointTree::Neighbour& a, const PointTree::Neighbour& b) {
  return a.distance < b.distance || (a.distance == b.distance && a.index < b.index);
}

}  // namespace

struct PointTree::Tree : KdTree<float> {
  using KdTree::KdTree;
};

PointTree::PointTree(std::vector<Vec3f> points) : tree_(std::make_unique<Tree>(std::move(points))) {}
PointTree::~PointTree() = default;
PointTree::PointTree(PointTree&&) noexcept = default;

size_t PointTree::size() const { return tree_->points().size(); }
const Vec3f& PointTree::point(size_t i) const { return tree_->points()[i]; }

void PointTree::nearest(const Vec3f& query, size_t k, std::vector<Neighbour>& out) const {
  out.clear();
  k = std::min(k, size());
  if (k == 0) return;
  thread_local std::vector<uint32_t> index;
  thread_local std::vector<float> squared;
  index.resize(k);
  squared.resize(k);
  const size_t found = tree_->nearest(query, k, index.data(), squared.data());
  for (size_t i = 0; i < found; ++i) out.push_back({index[i], std::sqrt(squared[i])});
  std::sort(out.begin(), out.end(), nearer);
}

bool PointTree::any_within(const Vec3f& query, double distance) const { return tree_->any_within(query, distance); }

void PointTree::within(const Vec3f& query, float radius, std::vector<Neighbour>& out) const {
  out.clear();
  if (!(radius > 0)) return;
  std::vector<std::pair<uint32_t, float>> found;
  tree_->within(query, radius * radius, found);
  for (const auto& [index, squared] : found) out.push_back({index, std::sqrt(squared)});
  std::sort(out.begin(), out.end(), nearer);
}

void PointTree::within_unordered(const Vec3f& query, float radius, std::vector<uint32_t>& out) const {
  out.clear();
  if (!(radius > 0)) return;
  thread_local std::vector<std::pair<uint32_t, float>> found;
  tree_->within_unordered(query, radius * radius, found);
  for (const auto& [index, squared] : found) out.push_back(index);
}

NeighbourGraph neighbour_graph(const std::vector<Vec3f>& points, size_t k, ThreadPool& pool) {
  std::vector<uint32_t> rows(points.size());
  std::iota(rows.begin(), rows.end(), 0u);
  return neighbour_graph(points, rows, k, pool);
}

NeighbourGraph neighbour_graph(const std::vector<Vec3f>& points, const std::vector<uint32_t>& rows, size_t k,
                               ThreadPool& pool) {
  return neighbour_graph(PointTree(points), rows, k, pool);
}

NeighbourGraph neighbour_graph(const PointTree& tree, const std::vector<uint32_t>& rows, size_t k, ThreadPool& pool) {
  NeighbourGraph graph;
  graph.k = k;
  graph.index.assign(rows.size() * k, NeighbourGraph::kNone);
  graph.distance.assign(rows.size() * k, std::numeric_limits<float>::infinity());
  pool.parallel_for(rows.size(), kQueryGrain, [&](size_t begin, size_t end, int) {
    std::vector<PointTree::Neighbour> found;
    for (size_t i = begin; i < end; ++i) {
      tree.nearest(tree.point(rows[i]), k + 1, found);
      size_t slot = 0;
      for (const PointTree::Neighbour& n : found) {
        if (n.index == rows[i] || slot == k) continue;
        graph.index[k * i + slot] = n.index;
        graph.distance[k * i + slot++] = n.distance;
      }
    }
  });
  return graph;
}

}  // namespace aligngs
