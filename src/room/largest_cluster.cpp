#include "room/largest_cluster.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "core/disjoint_sets.h"

namespace aligngs {

std::vector<Vec3d> largest_cluster(const std::vector<Vec3d>& points, double cell) {
  using Cube = std::array<int64_t, 3>;
  constexpr double kFarthest = 1e15;  // cubes: a farther place is no number of a cube
  if (!(cell > 0)) return {};
  std::map<Cube, uint32_t> cubes;
  std::vector<std::pair<const Vec3d*, uint32_t>> placed;
  for (const Vec3d& p : points) {
    Cube cube;
    bool ok = true;
    for (int k = 0; k < 3; ++k) {
      const double at = std::floor(p[k] / cell);
      ok = ok && std::abs(at) < kFarthest;
      cube[static_cast<size_t>(k)] = ok ? static_cast<int64_t>(at) : 0;
    }
    if (ok) placed.emplace_back(&p, cubes.try_emplace(cube, static_cast<uint32_t>(cubes.size())).first->second);
  }
  DisjointSets sets(cubes.size());
  for (const auto& [cube, number] : cubes) {
    for (int n = 0; n < 27; ++n) {
      const auto other = cubes.find({cube[0] + n % 3 - 1, cube[1] + n / 3 % 3 - 1, cube[2] + n / 9 - 1});
      if (other != cubes.end()) sets.unite(number, other->second);
    }
  }
  std::map<uint32_t, size_t> count;
  for (const auto& [p, number] : placed) ++count[sets.find(number)];
  uint32_t best = 0;
  size_t most = 0;
  for (const auto& [root, n] : count) {
    if (n > most) most = n, best = root;
  }
  std::vector<Vec3d> out;
  for (const auto& [p, number] : placed) {
    if (sets.find(number) == best) out.push_back(*p);
  }
  return out;
}

}  // namespace aligngs
