#include "refine/guided_match.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace aligngs {
namespace {

constexpr int kCoarseStep = 2;  // pixels of the first search; corners are some pixels wide

/// The patch of the first photo, and where its pixels are expected in the second.
struct Patch {
  std::vector<float> value;  ///< minus the mean, over the standard deviation times sqrt(n)
  std::vector<Vec2d> place;
  Vec2d centre;              ///< expected place of the corner itself
};

std::optional<Patch> carry_over(const MatchView& from, int x, int y, const MatchView& to, const MatchSettings& s) {
  if (from.depth.empty() || x < s.half_patch || y < s.half_patch || x >= from.luma.width - s.half_patch ||
      y >= from.luma.height - s.half_patch) {
    return {};
  }
  const float middle = from.depth.at(x, y);
  if (!(middle > 0) || !std::isfinite(middle)) return {};
  const Rigidd to_other = to.camera.world_to_camera * from.camera.world_to_camera.inverse();
  Patch patch;
  double sum = 0, squares = 0;
  for (int v = y - s.half_patch; v <= y + s.half_patch; ++v) {
    for (int u = x - s.half_patch; u <= x + s.half_patch; ++u) {
      const float z = from.depth.at(u, v);
      if (!(z > 0) || std::abs(z - middle) > static_cast<float>(s.depth_jump) * middle) return {};
      const Vec3d p = to_other * (from.camera.ray(u + 0.5, v + 0.5) * static_cast<double>(z));
      if (p.z <= 0) return {};
      patch.place.push_back(to.camera.project(p));
      if (u == x && v == y) patch.centre = patch.place.back();
      const double value = from.luma.at(u, v);
      patch.value.push_back(static_cast<float>(value));
      sum += value;
      squares += value * value;
    }
  }
  const double n = static_cast<double>(patch.value.size()), mean = sum / n;
  const double deviation = std::sqrt(std::max(squares / n - mean * mean, 0.0));
  if (deviation < s.least_contrast) return {};
  for (float& value : patch.value) value = static_cast<float>((value - mean) / (deviation * std::sqrt(n)));
  return patch;
}

float bilinear(const ImageF& image, double u, double v) {
  const double x = u - 0.5, y = v - 0.5;
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
  const float* row = &image.data[static_cast<size_t>(y0) * static_cast<size_t>(image.width) + static_cast<size_t>(x0)];
  const float* below = row + image.width;
  return (1 - fy) * ((1 - fx) * row[0] + fx * row[1]) + fy * ((1 - fx) * below[0] + fx * below[1]);
}

/// Normalised cross-correlation at a shift; -1 where the patch leaves the photo or the photo is flat.
double score_at(const Patch& patch, const ImageF& luma, double dx, double dy) {
  double dot = 0, sum = 0, squares = 0;
  for (size_t i = 0; i < patch.value.size(); ++i) {
    const double u = patch.place[i].x + dx, v = patch.place[i].y + dy;
    if (!(u >= 0.5 && v >= 0.5 && u < luma.width - 0.5 && v < luma.height - 0.5)) return -1;
    const double value = bilinear(luma, u, v);
    dot += patch.value[i] * value;
    sum += value;
    squares += value * value;
  }
  const double n = static_cast<double>(patch.value.size());
  const double spread = squares - sum * sum / n;
  return spread > 1e-6 * n ? dot / std::sqrt(spread) : -1;
}

/// Where a parabola through three scores has its top, in steps from the middle one.
double parabola_top(double left, double middle, double right) {
  const double curvature = left - 2 * middle + right;
  return curvature < 0 ? std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5) : 0;
}

}  // namespace

std::optional<Match> guided_match(const MatchView& from, int x, int y, const MatchView& to, const MatchSettings& s) {
  const std::optional<Patch> patch = carry_over(from, x, y, to, s);
  if (!patch) return {};
  const int reach = std::max(2, static_cast<int>(std::lround(s.search * to.luma.width)));
  struct Place {
    double score;
    int dx, dy;
  };
  std::vector<Place> coarse;
  for (int dy = -reach; dy <= reach; dy += kCoarseStep) {
    for (int dx = -reach; dx <= reach; dx += kCoarseStep) coarse.push_back({score_at(*patch, to.luma, dx, dy), dx, dy});
  }
  Place best = *std::max_element(coarse.begin(), coarse.end(), [](const Place& a, const Place& b) { return a.score < b.score; });
  if (best.score < 0.5 * s.least_score) return {};
  for (int round = 0; round < kCoarseStep; ++round) {  // the top may lie a step beyond the coarse grid's best
    const Place middle = best;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const double score = score_at(*patch, to.luma, middle.dx + dx, middle.dy + dy);
        if (score > best.score) best = {score, middle.dx + dx, middle.dy + dy};
      }
    }
  }
  if (best.score < s.least_score) return {};
  if (std::abs(best.dx) >= reach || std::abs(best.dy) >= reach) return {};  // the true place may lie outside
  for (const Place& other : coarse) {
    if (std::max(std::abs(other.dx - best.dx), std::abs(other.dy - best.dy)) < s.elsewhere) continue;
    if (other.score > best.score - s.least_margin) return {};
  }
  const auto around = [&](int dx, int dy) { return score_at(*patch, to.luma, best.dx + dx, best.dy + dy); };
  Match match;
  match.score = best.score;
  match.pixel = {patch->centre.x + best.dx + parabola_top(around(-1, 0), best.score, around(1, 0)),
                 patch->centre.y + best.dy + parabola_top(around(0, -1), best.score, around(0, 1))};
  return match;
}

}  // namespace aligngs
