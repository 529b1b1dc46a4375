#include "mesh/close_mesh.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace aligngs {
namespace {

uint64_t directed(uint32_t from, uint32_t to) { return uint64_t(from) << 32 | to; }
uint64_t undirected(uint32_t a, uint32_t b) { return directed(std::min(a, b), std::max(a, b)); }

/// For each vertex the first one at the same place.
std::vector<uint32_t> first_at_place(const TriangleMesh& mesh) {
  struct Hash {
    size_t operator()(const Vec3f& p) const {
      uint32_t bits[3];
      std::memcpy(bits, &p, sizeof bits);
      return (size_t(bits[0]) * 73856093u) ^ (size_t(bits[1]) * 19349663u) ^ (size_t(bits[2]) * 83492791u);
    }
  };
  struct Same {
    bool operator()(const Vec3f& a, const Vec3f& b) const { return a.x == b.x && a.y == b.y && a.z == b.z; }
  };
  std::unordered_map<Vec3f, uint32_t, Hash, Same> seen;
  seen.reserve(mesh.vertices.size());
  std::vector<uint32_t> first(mesh.vertices.size());
  for (uint32_t v = 0; v < first.size(); ++v) first[v] = seen.emplace(mesh.vertices[v], v).first->second;
  return first;
}

std::vector<std::array<uint32_t, 3>> welded(const TriangleMesh& mesh) {
  const std::vector<uint32_t> first = first_at_place(mesh);
  std::vector<std::array<uint32_t, 3>> out;
  for (const auto& t : mesh.triangles) {
    const std::array<uint32_t, 3> w{first[t[0]], first[t[1]], first[t[2]]};
    if (w[0] != w[1] && w[1] != w[2] && w[2] != w[0]) out.push_back(w);
  }
  return out;
}

/// How many triangles run along an edge in each direction.
using EdgeUse = std::map<std::pair<uint32_t, uint32_t>, std::pair<int, int>>;

EdgeUse edge_use(const std::vector<std::array<uint32_t, 3>>& triangles) {
  EdgeUse use;
  for (const auto& t : triangles) {
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = t[i], b = t[(i + 1) % 3];
      auto& [along, against] = use[{std::min(a, b), std::max(a, b)}];
      ++(a < b ? along : against);
    }
  }
  return use;
}

/// Closed lines along the border, against its triangles. A line that meets itself is parted there.
std::vector<std::vector<uint32_t>> borders(const EdgeUse& use) {
  std::map<uint32_t, std::vector<uint32_t>> next;
  for (const auto& [edge, count] : use) {
    for (int i = count.second; i < count.first; ++i) next[edge.second].push_back(edge.first);
    for (int i = count.first; i < count.second; ++i) next[edge.first].push_back(edge.second);
  }
  std::vector<std::vector<uint32_t>> loops;
  for (auto& [start, ways] : next) {
    while (!ways.empty()) {
      std::vector<uint32_t> path{start};
      std::unordered_map<uint32_t, size_t> at{{start, 0}};
      for (;;) {
        const auto step = next.find(path.back());
        if (step == next.end() || step->second.empty()) break;  // the mesh is not oriented there
        const uint32_t to = step->second.back();
        step->second.pop_back();
        const auto met = at.find(to);
        if (met == at.end()) {
          at[to] = path.size();
          path.push_back(to);
          continue;
        }
        loops.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(met->second), path.end());
        for (size_t i = met->second + 1; i < path.size(); ++i) at.erase(path[i]);
        path.resize(met->second + 1);
        if (path.size() == 1) break;
      }
    }
  }
  return loops;
}

/// Cuts ears off one border.
class EarCutter {
 public:
  EarCutter(const TriangleMesh& mesh, const std::vector<uint32_t>& loop, const std::unordered_set<uint64_t>& edges)
      : mesh_(mesh), loop_(loop), edges_(edges), next_(loop.size()), last_(loop.size()) {
    for (uint32_t i = 0; i < loop.size(); ++i) {
      next_[i] = (i + 1) % static_cast<uint32_t>(loop.size());
      last_[next_[i]] = i;
    }
    for (uint32_t i = 0; i < loop.size(); ++i) {  // Newell's normal
      const Vec3d a = place(i), b = place(next_[i]);
      normal_ += Vec3d{(a.y - b.y) * (a.z + b.z), (a.z - b.z) * (a.x + b.x), (a.x - b.x) * (a.y + b.y)};
    }
  }
  /// Empty where no way is found.
  std::vector<std::array<uint32_t, 3>> cut() {
    std::vector<std::array<uint32_t, 3>> out;
    std::set<std::pair<double, uint32_t>> ears;
    for (uint32_t i = 0; i < loop_.size(); ++i) ears.insert({length(i), i});
    size_t left = loop_.size();
    while (left > 3) {
      // First ears that lie inside, then any: a border in space need not have one.
      const auto found = find(ears, left);
      if (found == ears.end()) return {};
      const uint32_t i = found->second, before = last_[i], after = next_[i];
      ears.erase(found);
      ears.erase({length(before), before});
      ears.erase({length(after), after});
      out.push_back({loop_[before], loop_[i], loop_[after]});
      added_.insert(undirected(loop_[before], loop_[after]));
      next_[before] = after;
      last_[after] = before;
      ears.insert({length(before), before});
      ears.insert({length(after), after});
      --left;
    }
    const uint32_t i = ears.begin()->second;
    out.push_back({loop_[last_[i]], loop_[i], loop_[next_[i]]});
    return out;
  }

 private:
  Vec3d place(uint32_t i) const { return mesh_.vertices[loop_[i]].cast<double>(); }
  double length(uint32_t i) const { return norm(place(next_[i]) - place(last_[i])); }
  bool possible(uint32_t i) const {
    const uint64_t edge = undirected(loop_[last_[i]], loop_[next_[i]]);
    return !edges_.count(edge) && !added_.count(edge);
  }
  /// Convex as seen along the normal, and no other vertex of the border in it.
  bool inside(uint32_t i) const {
    const Vec3d a = place(last_[i]), b = place(i), c = place(next_[i]);
    if (dot(cross(b - a, c - b), normal_) <= 0) return false;
    for (uint32_t k = next_[next_[i]]; k != last_[i]; k = next_[k]) {
      const Vec3d p = place(k);
      if (dot(cross(b - a, p - a), normal_) > 0 && dot(cross(c - b, p - b), normal_) > 0 &&
          dot(cross(a - c, p - c), normal_) > 0)
        return false;
    }
    return true;
  }
  std::set<std::pair<double, uint32_t>>::iterator find(std::set<std::pair<double, uint32_t>>& ears, size_t left) const {
    // A trial looks at the whole border: only the shortest ears of a long one are tried.
    constexpr size_t kTrials = 200;
    size_t trials = 0;
    const size_t most = std::min(left, kTrials);
    for (auto ear = ears.begin(); ear != ears.end() && trials < most; ++ear, ++trials) {
      if (possible(ear->second) && inside(ear->second)) return ear;
    }
    return std::find_if(ears.begin(), ears.end(), [&](const auto& ear) { return possible(ear.second); });
  }

  const TriangleMesh& mesh_;
  const std::vector<uint32_t>& loop_;
  const std::unordered_set<uint64_t>& edges_;
  std::unordered_set<uint64_t> added_;
  std::vector<uint32_t> next_, last_;
  Vec3d normal_;
};

/// A vertex in the middle of a border, with the mean of its attributes and the first one's label.
uint32_t add_middle(TriangleMesh& mesh, const std::vector<uint32_t>& loop) {
  Vec3d place{}, normal{}, color{};
  for (const uint32_t v : loop) {
    place += mesh.vertices[v].cast<double>();
    if (!mesh.normals.empty()) normal += mesh.normals[v].cast<double>();
    for (int c = 0; c < 3 && !mesh.colors.empty(); ++c) color[c] += mesh.colors[v][static_cast<size_t>(c)];
  }
  const double share = 1 / static_cast<double>(loop.size());
  const auto channel = [&](double sum) { return static_cast<uint8_t>(sum * share + 0.5); };
  mesh.vertices.push_back((place * share).cast<float>());
  if (!mesh.normals.empty()) mesh.normals.push_back(normalized(normal).cast<float>());
  if (!mesh.colors.empty()) mesh.colors.push_back({channel(color.x), channel(color.y), channel(color.z)});
  if (!mesh.labels.empty()) mesh.labels.push_back(mesh.labels[loop.front()]);
  return static_cast<uint32_t>(mesh.vertices.size() - 1);
}

/// A fan around a vertex in the middle. Its edges are all new, so that it closes what ears cannot.
std::vector<std::array<uint32_t, 3>> fan(TriangleMesh& mesh, const std::vector<uint32_t>& loop) {
  const uint32_t middle = add_middle(mesh, loop);
  std::vector<std::array<uint32_t, 3>> out;
  for (size_t i = 0; i < loop.size(); ++i) out.push_back({loop[i], loop[(i + 1) % loop.size()], middle});
  return out;
}

size_t count_open(const EdgeUse& use) {
  return static_cast<size_t>(
      std::count_if(use.begin(), use.end(), [](const auto& u) { return u.second.first != u.second.second; }));
}

}  // namespace

size_t open_edges(const TriangleMesh& mesh) { return count_open(edge_use(welded(mesh))); }

ClosingReport close_mesh(TriangleMesh& mesh) {
  ClosingReport report;
  mesh.triangles = welded(mesh);
  const EdgeUse use = edge_use(mesh.triangles);
  std::unordered_set<uint64_t> edges;
  for (const auto& [edge, count] : use) edges.insert(undirected(edge.first, edge.second));
  for (const std::vector<uint32_t>& loop : borders(use)) {
    if (loop.size() < 3) continue;
    auto filling = EarCutter(mesh, loop, edges).cut();
    if (filling.empty()) filling = fan(mesh, loop);
    ++report.holes;
    report.triangles += filling.size();
    for (const auto& t : filling) {
      mesh.triangles.push_back(t);
      for (size_t i = 0; i < 3; ++i) edges.insert(undirected(t[i], t[(i + 1) % 3]));
    }
  }
  report.open_edges = open_edges(mesh);
  return report;
}

}  // namespace aligngs
