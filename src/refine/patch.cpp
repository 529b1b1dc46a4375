#include "refine/patch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "core/target_clones.h"
#include "core/vector_lanes.h"
#include "refine/patch_taps.h"

namespace aligngs {
namespace {

constexpr double kFlat = 1e-6;  // variance of luma that is none

/// `shift`: from a tap's place to that of the first shift, in pixels of the row-major photo.
ALIGNGS_TARGET_CLONES
void add_taps_of_neighbours(const ShiftedScores::Tap* taps, size_t count, const float* pixels, ptrdiff_t width,
                            ptrdiff_t shift, ShiftedScores::Sums& out) {
  TapSums sums;
  for (size_t t = 0; t < count; ++t) {
    const float* const upper = pixels + (taps[t].row * width + taps[t].column + shift);
    TapCorners c;
    std::memcpy(&c.upper_left, upper, sizeof(FloatLanes));
    std::memcpy(&c.upper_right, upper + 1, sizeof(FloatLanes));
    std::memcpy(&c.lower_left, upper + width, sizeof(FloatLanes));
    std::memcpy(&c.lower_right, upper + width + 1, sizeof(FloatLanes));
    add_tap(taps[t], c, sums);
  }
  store(sums, out);
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
  const size_t side = static_cast<size_t>(2 * s.half_patch + 1);
  patch.place.reserve(side * side);
  patch.value.reserve(side * side);
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

double ShiftedScores::score(double dot, double sum, double squares) const {
  const double n = static_cast<double>(taps_.size()), spread = squares - sum * sum / n;
  return spread > kFlat * n ? dot / std::sqrt(spread) : kOutside;
}

double ShiftedScores::at(int dx, int dy) const {
  if (first_row_ + dy < 0 || last_row_ + dy > luma_.height - 2) return kOutside;
  if (first_column_ + dx < 0 || last_column_ + dx > luma_.width - 2) return kOutside;
  double dot = 0, sum = 0, squares = 0;
  for (const Tap& tap : taps_) {
    const int x = tap.column + dx, y = tap.row + dy;
    const float top = (1 - tap.right) * luma_.at(x, y) + tap.right * luma_.at(x + 1, y),
                bottom = (1 - tap.right) * luma_.at(x, y + 1) + tap.right * luma_.at(x + 1, y + 1);
    const double luma = (1 - tap.down) * top + tap.down * bottom;
    dot += static_cast<double>(tap.value) * luma;
    sum += luma;
    squares += luma * luma;
  }
  return score(dot, sum, squares);
}

void ShiftedScores::row(int first, int count, int dy, double* out) const {
  std::fill(out, out + count, kOutside);
  if (first_row_ + dy < 0 || last_row_ + dy > luma_.height - 2) return;
  // The shifts that keep all four pixels under every tap inside of the photo.
  const int begin = std::max(0, -first_column_ - first);
  const int end = std::min(count, luma_.width - 1 - last_column_ - first);
  const ptrdiff_t width = luma_.width, pixels = static_cast<ptrdiff_t>(luma_.data.size());
  for (int k = begin; k < end; k += kLanes) {
    const int dx = first + k, inside = std::min(kLanes, end - k);
    // One more row below, and the pixels of every shift.
    const ptrdiff_t past = (last_row_ + dy + 1) * width + last_column_ + dx + kLanes + 1;
    if (past > pixels) {  // at the photo's end
      for (int i = 0; i < inside; ++i) out[k + i] = at(dx + i, dy);
      continue;
    }
    Sums sums;
    add_taps_of_neighbours(taps_.data(), taps_.size(), luma_.data.data(), width, dy * width + dx, sums);
    for (int i = 0; i < inside; ++i) out[k + i] = score(sums.dot[i], sums.sum[i], sums.squares[i]);
  }
}

}  // namespace aligngs
