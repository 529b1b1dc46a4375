#include "refine/view_overlap.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"

namespace aligngs {
namespace {

constexpr int kGrid = 12;  // samples a side; 144 tell a quarter from a third

}  // namespace

double view_overlap(const MatchView& from, const MatchView& to, double largest_turn) {
  if (from.depth.empty() ||
      dot(from.camera.forward(), to.camera.forward()) < std::cos(largest_turn * kRadiansPerDegree))
    return 0;
  const Rigidd to_other = to.camera.world_to_camera * from.camera.world_to_camera.inverse();
  int inside = 0, valid = 0;
  for (int j = 0; j < kGrid; ++j) {
    for (int i = 0; i < kGrid; ++i) {
      const int x = (2 * i + 1) * from.depth.width / (2 * kGrid), y = (2 * j + 1) * from.depth.height / (2 * kGrid);
      const float z = from.depth.at(x, y);
      if (!(z > 0)) continue;
      ++valid;
      const Vec3d p = to_other * (from.camera.ray(x + 0.5, y + 0.5) * static_cast<double>(z));
      if (p.z > 0 && to.camera.contains(to.camera.project(p))) ++inside;
    }
  }
  return valid == 0 ? 0 : static_cast<double>(inside) / valid;
}

std::vector<std::vector<int>> overlapping_views(const std::vector<const MatchView*>& from,
                                                const std::vector<const MatchView*>& to, int count, double least,
                                                double largest_turn) {
  std::vector<std::vector<int>> out(from.size());
  for (size_t i = 0; i < from.size(); ++i) {
    std::vector<std::pair<double, int>> shares;
    for (size_t j = 0; j < to.size(); ++j) {
      if (from[i] == to[j]) continue;
      const double share = view_overlap(*from[i], *to[j], largest_turn);
      if (share >= least) shares.emplace_back(-share, static_cast<int>(j));
    }
    std::sort(shares.begin(), shares.end());
    for (size_t k = 0; k < shares.size() && k < static_cast<size_t>(count); ++k) out[i].push_back(shares[k].second);
  }
  return out;
}

std::optional<PixelIndex> pixel_showing(const Vec3d& place, const Camera& camera, const ImageF& depth,
                                        double agreement) {
  const Vec3d p = camera.world_to_camera * place;
  if (!(p.z > 0)) return {};
  const Vec2d at = camera.project(p);
  if (!camera.contains(at)) return {};
  const PixelIndex pixel{static_cast<int>(at.x), static_cast<int>(at.y)};
  const double seen = static_cast<double>(depth.at(pixel.x, pixel.y));
  if (!(std::abs(seen - p.z) <= agreement * p.z)) return {};  // also where there is none, or no number
  return pixel;
}

}  // namespace aligngs
