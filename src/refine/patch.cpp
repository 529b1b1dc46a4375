#include "refine/patch.h"

#include <algorithm>
#include <cmath>

#include "core/target_clones.h"

namespace aligngs {
namespace {

constexpr double kFlat = 1e-6;  // variance of luma that is none

/// Sums over a patch, for neighbouring shifts.
struct RowSums {
  double* dot;
  double* sum;
  double* squares;
};

ALIGNGS_TARGET_CLONES
void add_tap(const float* upper, const float* lower, float right, float down, float value, int count,
             const RowSums& sums) {
  double* __restrict dot = sums.dot;
  double* __restrict sum = sums.sum;
  double* __restrict squares = sums.squares;
  for (int k = 0; k < count; ++k) {
    const float top = (1 - right) * upper[k] + right * upper[k + 1],
                bottom = (1 - right) * lower[k] + right * lower[k + 1];
    const double luma = (1 - down) * top + down * bottom;
    dot[k] += value * luma;
    sum[k] += luma;
    squares[k] += luma * luma;
  }
}

}  // namespace

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

ShiftedScores::ShiftedScores(const Patch& patch, const ImageF& luma) : luma_(luma) {
  // Places far outside are equal: no requested shift brings them back.
  static constexpr double kFar = 1e8;
  const auto corner = [](double place) { return place > -kFar ? std::floor(std::min(place, kFar) - 0.5) : -kFar; };
  first_column_ = first_row_ = static_cast<int>(kFar);
  last_column_ = last_row_ = -static_cast<int>(kFar);
  taps_.reserve(patch.value.size());
  for (size_t i = 0; i < patch.value.size(); ++i) {
    const double x = corner(patch.place[i].x), y = corner(patch.place[i].y);
    const Tap tap{static_cast<int>(x), static_cast<int>(y), static_cast<float>(patch.place[i].x - 0.5 - x),
                  static_cast<float>(patch.place[i].y - 0.5 - y), patch.value[i]};
    first_column_ = std::min(first_column_, tap.column);
    last_column_ = std::max(last_column_, tap.column);
    first_row_ = std::min(first_row_, tap.row);
    last_row_ = std::max(last_row_, tap.row);
    taps_.push_back(tap);
  }
}

double ShiftedScores::at(int dx, int dy) {
  double score;
  row(dx, 1, dy, &score);
  return score;
}

void ShiftedScores::row(int first, int count, int dy, double* out) {
  std::fill(out, out + count, kOutside);
  if (first_row_ + dy < 0 || last_row_ + dy > luma_.height - 2) return;
  // The shifts that keep all four pixels under every tap inside of the photo.
  const int begin = std::max(first, -first_column_), end = std::min(first + count, luma_.width - 1 - last_column_);
  const int inside = end - begin;
  if (inside <= 0) return;
  for (std::vector<double>* sums : {&dot_, &sum_, &squares_}) sums->assign(static_cast<size_t>(inside), 0.0);
  const size_t width = static_cast<size_t>(luma_.width);
  for (const Tap& tap : taps_) {
    const float* upper =
        &luma_.data[static_cast<size_t>(tap.row + dy) * width + static_cast<size_t>(tap.column + begin)];
    add_tap(upper, upper + width, tap.right, tap.down, tap.value, inside, {dot_.data(), sum_.data(), squares_.data()});
  }
  const double n = static_cast<double>(taps_.size());
  for (int k = 0; k < inside; ++k) {
    const size_t i = static_cast<size_t>(k);
    const double spread = squares_[i] - sum_[i] * sum_[i] / n;
    if (spread > kFlat * n) out[begin - first + k] = dot_[i] / std::sqrt(spread);
  }
}

}  // namespace aligngs
