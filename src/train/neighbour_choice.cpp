#include "train/neighbour_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/angles.h"
#include "train/random_purpose.h"

namespace aligngs {

std::vector<std::vector<int>> choose_neighbours(const std::vector<Camera>& cameras, double extent,
                                                const NeighbourRule& rule) {
  const double cosine_min = std::cos(rule.angle_max * kPi / 180);
  const double low = rule.distance_min * extent, high = rule.distance_max * extent;
  std::vector<std::vector<int>> out(cameras.size());
  for (size_t i = 0; i < cameras.size(); ++i) {
    std::vector<std::pair<double, int>> near;
    for (size_t j = 0; j < cameras.size(); ++j) {
      if (j == i) continue;
      const double distance = norm(cameras[j].centre() - cameras[i].centre());
      const double cosine = dot(cameras[i].forward(), cameras[j].forward());
      if (cosine > cosine_min && distance > low && distance < high) near.emplace_back(distance, static_cast<int>(j));
    }
    std::sort(near.begin(), near.end());
    for (size_t k = 0; k < std::min(rule.most, near.size()); ++k) out[i].push_back(near[k].second);
  }
  return out;
}

DrawnNeighbour draw_neighbour(const std::vector<int>& neighbours, uint64_t run_seed, int64_t iteration) {
  if (neighbours.empty()) return {};
  Random random = random_of(run_seed, RandomPurpose::kNeighbour).fork(static_cast<uint64_t>(iteration));
  const int view = neighbours[static_cast<size_t>(random.below(static_cast<int>(neighbours.size())))];
  return {view, random.next()};
}

}  // namespace aligngs
