#include "refine/patch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "core/target_clones.h"
#include "core/vector_lanes.h"

namespace aligngs {
namespace {

constexpr double kFlat = 1e-6;  // variance of luma that is none

/// `shift`: from a tap's place to that of the first shift, in pixels of the row-major photo.
template <int kStep>
ALIGNGS_ALWAYS_INLINE void add_taps(const ShiftedScores::Tap* taps, size_t count, const float* pixels, ptrdiff_t width,
                                    ptrdiff_t shift, ShiftedScores::Sums& out) {
  DoubleLanes dot{}, sum{}, squares{};
  for (size_t t = 0; t < count; ++t) {
    const ShiftedScores::Tap& tap = taps[t];
    const float* const upper = pixels + (tap.row * width + tap.column + shift);
    const float* const lower = upper + width;
    FloatLanes left[2], right[2];  // of the upper and the lower row
    for (int k = 0; k < 2; ++k) {
      const float* const from = k == 0 ? upper : lower;
      if constexpr (kStep == 1) {
        std::memcpy(&left[k], from, sizeof(FloatLanes));
        std::memcpy(&right[k], from + 1, sizeof(FloatLanes));
      } else {
        FloatLanes near, far;
        std::memcpy(&near, from, sizeof(FloatLanes));
        std::memcpy(&far, from + kLanes, sizeof(FloatLanes));
        left[k] = __builtin_shufflevector(near, far, 0, 2, 4, 6, 8, 10, 12, 14);
        right[k] = __builtin_shufflevector(near, far, 1, 3, 5, 7, 9, 11, 13, 15);
      }
    }
    const FloatLanes top = (1 - tap.right) * left[0] + tap.right * right[0],
                     bottom = (1 - tap.right) * left[1] + tap.right * right[1];
    const FloatLanes mixed = (1 - tap.down) * top + tap.down * bottom;
    const DoubleLanes luma = __builtin_convertvector(mixed, DoubleLanes);
    dot += static_cast<double>(tap.value) * luma;
    sum += luma;
    squares += luma * luma;
  }
  std::memcpy(out.dot, &dot, sizeof(dot));
  std::memcpy(out.sum, &sum, sizeof(sum));
  std::memcpy(out.squares, &squares, sizeof(squares));
}

ALIGNGS_TARGET_CLONES
void add_taps_of_neighbours(const ShiftedScores::Tap* taps, size_t count, const float* pixels, ptrdiff_t width,
                            ptrdiff_t shift, ShiftedScores::Sums& out) {
  add_taps<1>(taps, count, pixels, width, shift, out);
}

ALIGNGS_TARGET_CLONES
void add_taps_of_every_second(const ShiftedScores::Tap* taps, size_t count, const float* pixels, ptrdiff_t width,
                              ptrdiff_t shift, ShiftedScores::Sums& out) {
  add_taps<2>(taps, count, pixels, width, shift, out);
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

void ShiftedScores::row(int first, int count, int step, int dy, double* out) const {
  std::fill(out, out + count, kOutside);
  if (first_row_ + dy < 0 || last_row_ + dy > luma_.height - 2) return;
  // The shifts that keep all four pixels under every tap inside of the photo.
  const int least = -first_column_, most = luma_.width - 2 - last_column_;
  const int begin = first >= least ? 0 : (least - first + step - 1) / step;
  const int end = most >= first ? std::min(count, (most - first) / step + 1) : 0;
  const ptrdiff_t width = luma_.width, pixels = static_cast<ptrdiff_t>(luma_.data.size());
  for (int k = begin; k < end; k += kLanes) {
    const int dx = first + k * step, inside = std::min(kLanes, end - k);
    // One more row below, and the step's pixels of every shift.
    const ptrdiff_t past = (last_row_ + dy + 1) * width + last_column_ + dx + step * kLanes + 1;
    if (past > pixels) {  // at the photo's end
      for (int i = 0; i < inside; ++i) out[k + i] = at(dx + i * step, dy);
      continue;
    }
    Sums sums;
    (step == 1 ? add_taps_of_neighbours : add_taps_of_every_second)(taps_.data(), taps_.size(), luma_.data.data(),
                                                                    width, dy * width + dx, sums);
    for (int i = 0; i < inside; ++i) out[k + i] = score(sums.dot[i], sums.sum[i], sums.squares[i]);
  }
}

}  // namespace aligngs
