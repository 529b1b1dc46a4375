// Every second shift of a square. The photo there is copied with its even and odd columns apart, so that shifts side by
// side read numbers side by side.
#include <algorithm>
#include <cstddef>
#include <cstring>

#include "core/target_clones.h"
#include "refine/patch.h"
#include "refine/patch_taps.h"

namespace aligngs {
namespace {

constexpr int kFew = 2;  // shifts that take less time one by one than as lanes

/// A tap and the copy's numbers to its left and right, at the first shift, in the upper row.
struct PlacedTap {
  ShiftedScores::Tap tap;
  ptrdiff_t left, right;
};

/// `lower`: from a row of the copy to the next.
ALIGNGS_TARGET_CLONES
void add_placed_taps(const PlacedTap* taps, size_t count, const float* numbers, ptrdiff_t lower,
                     ShiftedScores::Sums& out) {
  TapSums sums;
  for (size_t t = 0; t < count; ++t) {
    const float *const left = numbers + taps[t].left, *const right = numbers + taps[t].right;
    TapCorners c;
    std::memcpy(&c.upper_left, left, sizeof(FloatLanes));
    std::memcpy(&c.upper_right, right, sizeof(FloatLanes));
    std::memcpy(&c.lower_left, left + lower, sizeof(FloatLanes));
    std::memcpy(&c.lower_right, right + lower, sizeof(FloatLanes));
    add_tap(taps[t].tap, c, sums);
  }
  store(sums, out);
}

/// Numbers at even places, and those at odd ones.
ALIGNGS_TARGET_CLONES
void split_columns(const float* numbers, int count, float* even_out, float* odd_out) {
  const float* __restrict in = numbers;
  float* __restrict even = even_out;
  float* __restrict odd = odd_out;
  for (int i = 0; i < count / 2; ++i) {
    even[i] = in[2 * i];
    odd[i] = in[2 * i + 1];
  }
  if (count % 2 != 0) even[count / 2] = in[count - 1];
}

/// The first place among `count`, a step of two apart from `first` on, that lies at `least` or beyond.
int first_inside(int first, int least, int count) { return std::clamp((least - first + 1) / 2, 0, count); }
/// One past the last that lies at `most` or before.
int past_inside(int first, int most, int count) { return most < first ? 0 : std::min(count, (most - first) / 2 + 1); }

}  // namespace

std::vector<double> ShiftedScores::every_second(int reach) const {
  const int side = reach + 1;
  std::vector<double> out(static_cast<size_t>(side) * static_cast<size_t>(side), kOutside);
  const int left = first_inside(-reach, -first_column_, side), top = first_inside(-reach, -first_row_, side);
  const int right = past_inside(-reach, luma_.width - 2 - last_column_, side),
            bottom = past_inside(-reach, luma_.height - 2 - last_row_, side);
  if (left >= right || top >= bottom) return out;

  // the part of the photo under the taps at all these shifts
  const int x0 = first_column_ - reach + 2 * left, y0 = first_row_ - reach + 2 * top;
  const int width = last_column_ - first_column_ + 2 * (right - left),
            height = last_row_ - first_row_ + 2 * (bottom - top);
  const ptrdiff_t half = width / 2 + 1 + kLanes;  // lanes beyond the last shift are read, and not used
  std::vector<float> copy(static_cast<size_t>(2 * half * height), 0.0f);
  for (int y = 0; y < height; ++y) {
    float* const even = &copy[static_cast<size_t>(2 * y * half)];
    split_columns(luma_.pixel(x0, y0 + y), width, even, even + half);
  }
  std::vector<PlacedTap> taps;
  taps.reserve(taps_.size());
  for (const Tap& tap : taps_) {
    const int x = tap.column - first_column_, y = tap.row - first_row_;
    const auto place = [&](int column) { return (2 * y + (column & 1)) * half + column / 2; };
    taps.push_back({tap, place(x), place(x + 1)});
  }
  for (int j = top; j < bottom; ++j) {
    double* const row = &out[static_cast<size_t>(j) * static_cast<size_t>(side)];
    const float* const numbers = copy.data() + (j - top) * 4 * half;  // two rows further down
    for (int k = left; k < right; k += kLanes) {
      const int inside = std::min(kLanes, right - k);
      if (inside <= kFew) {
        for (int i = 0; i < inside; ++i) row[k + i] = at(2 * (k + i) - reach, 2 * j - reach);
        continue;
      }
      Sums sums;
      add_placed_taps(taps.data(), taps.size(), numbers + (k - left), 2 * half, sums);
      for (int i = 0; i < inside; ++i) row[k + i] = score(sums.dot[i], sums.sum[i], sums.squares[i]);
    }
  }
  return out;
}

}  // namespace aligngs
