#include "gaussians/point_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <utility>

namespace aligngs {
namespace {

constexpr size_t kGrain = 1024;  // queries per chunk

struct Cloud {
  std::vector<Vec3f> points;
  size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(size_t i, size_t axis) const { return points[i][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, uint32_t>;

bool nearer(const PointTree::Neighbour& a, const PointTree::Neighbour& b) {
  return a.distance < b.distance || (a.distance == b.distance && a.index < b.index);
}

}  // namespace

struct PointTree::Tree {
  Cloud cloud;
  std::unique_ptr<Index> index;
};

PointTree::PointTree(std::vector<Vec3f> points) : tree_(std::make_unique<Tree>()) {
  tree_->cloud.points = std::move(points);
  if (tree_->cloud.points.empty()) return;
  tree_->index = std::make_unique<Index>(3, tree_->cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  tree_->index->buildIndex();
}
PointTree::~PointTree() = default;
PointTree::PointTree(PointTree&&) noexcept = default;

size_t PointTree::size() const { return tree_->cloud.points.size(); }
const Vec3f& PointTree::point(size_t i) const { return tree_->cloud.points[i]; }

void PointTree::nearest(const Vec3f& query, size_t k, std::vector<Neighbour>& out) const {
  out.clear();
  k = std::min(k, size());
  if (k == 0) return;
  std::vector<uint32_t> index(k);
  std::vector<float> squared(k);
  nanoflann::KNNResultSet<float, uint32_t> result(k);
  result.init(index.data(), squared.data());
  tree_->index->findNeighbors(result, &query.x, nanoflann::SearchParams());
  for (size_t i = 0; i < result.size(); ++i) out.push_back({index[i], std::sqrt(squared[i])});
  std::sort(out.begin(), out.end(), nearer);
}

void PointTree::within(const Vec3f& query, float radius, std::vector<Neighbour>& out) const {
  out.clear();
  if (size() == 0 || !(radius > 0)) return;
  std::vector<std::pair<uint32_t, float>> found;
  tree_->index->radiusSearch(&query.x, radius * radius, found, nanoflann::SearchParams());
  for (const auto& [index, squared] : found) out.push_back({index, std::sqrt(squared)});
  std::sort(out.begin(), out.end(), nearer);
}

NeighbourGraph neighbour_graph(const std::vector<Vec3f>& points, size_t k, ThreadPool& pool) {
  NeighbourGraph graph;
  graph.k = k;
  graph.index.assign(points.size() * k, NeighbourGraph::kNone);
  graph.distance.assign(points.size() * k, std::numeric_limits<float>::infinity());
  const PointTree tree(points);
  pool.parallel_for(points.size(), kGrain, [&](size_t begin, size_t end, int) {
    std::vector<PointTree::Neighbour> found;
    for (size_t i = begin; i < end; ++i) {
      tree.nearest(points[i], k + 1, found);
      size_t slot = 0;
      for (const PointTree::Neighbour& n : found) {
        if (n.index == i || slot == k) continue;
        graph.index[k * i + slot] = n.index;
        graph.distance[k * i + slot++] = n.distance;
      }
    }
  });
  return graph;
}

}  // namespace aligngs
