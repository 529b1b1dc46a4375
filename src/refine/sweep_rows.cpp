#include "refine/sweep_rows.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/target_clones.h"
#include "core/vector_lanes.h"

namespace aligngs {
namespace {

constexpr float kFlatShare = 0.25f;  // of the least variance: the other photo may be darker, not featureless
constexpr int kUsualTerms = 7;       // rows of the usual window

// Lanes are passed by reference: who returns them by value has another ABI on each instruction set.
ALIGNGS_ALWAYS_INLINE void load_lanes(FloatLanes& out, const float* from) { std::memcpy(&out, from, sizeof(out)); }

ALIGNGS_ALWAYS_INLINE void add_lanes(FloatLanes& sum, const float* from) {
  FloatLanes term;
  load_lanes(term, from);
  sum += term;
}

// No branches: every pixel is computed, and those that do not count are multiplied away. Places are kept inside of the
// photo first, so that what is read is always there. The compiler believes only of parameters that they do not overlap.
ALIGNGS_TARGET_CLONES
void warp_pixels(const WarpedRow& row, const float* __restrict dx, const float* __restrict dy,
                 const float* __restrict dz, const float* __restrict depth, const float* __restrict own,
                 const float* __restrict luma, int pixels, float* __restrict count, float* __restrict own_out,
                 float* __restrict own2, float* __restrict other, float* __restrict other2, float* __restrict product) {
  const float origin_x = row.origin.x, origin_y = row.origin.y, origin_z = row.origin.z;
  const float factor = row.factor, fx = row.fx, fy = row.fy, cx = row.cx, cy = row.cy, middle = row.middle;
  const int width = row.width, most_x = row.width - 2, most_y = row.height - 2;
  const float last_x = static_cast<float>(row.width - 1), last_y = static_cast<float>(row.height - 1);
  for (int i = 0; i < pixels; ++i) {
    const float x = factor * dx[i] + origin_x, y = factor * dy[i] + origin_y, z = factor * dz[i] + origin_z;
    const float inverse = 1 / z, u = fx * x * inverse + cx, v = fy * y * inverse + cy;
    const float bounded_x = u > 0 ? u : 0.0f, bounded_y = v > 0 ? v : 0.0f;
    const float at_x = bounded_x < last_x ? bounded_x : last_x, at_y = bounded_y < last_y ? bounded_y : last_y;
    const int floor_x = static_cast<int>(at_x), floor_y = static_cast<int>(at_y);
    const int column = floor_x < most_x ? floor_x : most_x, line = floor_y < most_y ? floor_y : most_y,
              at = line * width + column;
    const float a = at_x - static_cast<float>(column), b = at_y - static_cast<float>(line);
    const int inside = static_cast<int>(z > 0) & static_cast<int>(depth[i] > 0) & static_cast<int>(u >= 0) &
                       static_cast<int>(v >= 0) & static_cast<int>(u <= last_x) & static_cast<int>(v <= last_y);
    const float counts = static_cast<float>(inside);
    const float top = (1 - a) * luma[at] + a * luma[at + 1],
                bottom = (1 - a) * luma[at + width] + a * luma[at + width + 1];
    const float j = counts * ((1 - b) * top + b * bottom - middle), mine = counts * own[i];
    count[i] = counts;
    own_out[i] = mine;
    own2[i] = mine * mine;
    other[i] = j;
    other2[i] = j * j;
    product[i] = mine * j;
  }
}

}  // namespace

void warp_row(const WarpedRow& row, int count, const WindowTerms& out) {
  warp_pixels(row, row.x, row.y, row.z, row.depth, row.own, row.luma, count, out.count, out.own, out.own2, out.other,
              out.other2, out.product);
}

ALIGNGS_TARGET_CLONES
void sum_rows(const float* const* rows, int terms, int count, float* out) {
  int i = 0;
  if (terms == kUsualTerms) {
    const float *const a = rows[0], *const b = rows[1], *const c = rows[2], *const d = rows[3], *const e = rows[4],
                       *const f = rows[5], *const g = rows[6];
    for (; i + kLanes <= count; i += kLanes) {
      FloatLanes sum;
      load_lanes(sum, a + i);
      add_lanes(sum, b + i);
      add_lanes(sum, c + i);
      add_lanes(sum, d + i);
      add_lanes(sum, e + i);
      add_lanes(sum, f + i);
      add_lanes(sum, g + i);
      std::memcpy(out + i, &sum, sizeof(sum));
    }
  }
  for (; i + kLanes <= count; i += kLanes) {  // sums stay in registers
    FloatLanes sum;
    load_lanes(sum, rows[0] + i);
    for (int term = 1; term < terms; ++term) add_lanes(sum, rows[term] + i);
    std::memcpy(out + i, &sum, sizeof(sum));
  }
  for (; i < count; ++i) {
    float sum = rows[0][i];
    for (int term = 1; term < terms; ++term) sum += rows[term][i];
    out[i] = sum;
  }
}

ALIGNGS_TARGET_CLONES
void score_row(const WindowTerms& sums, const float* pixel_count, const ScoreRule& rule, int pixels, float* scores) {
  float* __restrict out = scores;
  const float* __restrict count = sums.count;
  const float* __restrict own = sums.own;
  const float* __restrict own2 = sums.own2;
  const float* __restrict other = sums.other;
  const float* __restrict other2 = sums.other2;
  const float* __restrict product = sums.product;
  const float* __restrict itself = pixel_count;
  const float least = rule.least_count, least_variance = rule.least_variance, none = rule.none;
  const float flat = kFlatShare * least_variance;
  for (int i = 0; i < pixels; ++i) {
    const float share = 1 / count[i], mean = own[i] * share, mean_other = other[i] * share;
    const float variance = own2[i] * share - mean * mean, variance_other = other2[i] * share - mean_other * mean_other;
    const float covariance = product[i] * share - mean * mean_other;
    const float correlation = covariance / std::sqrt(variance * variance_other);
    const float bounded = correlation > -1 ? (correlation < 1 ? correlation : 1.0f) : -1.0f;
    // A flat window on the other side says that the place looks different there, not that nothing is known.
    const float score = variance_other < flat ? 0.0f : bounded;
    out[i] = ((itself[i] > 0) & (count[i] >= least) & (variance >= least_variance)) != 0 ? score : none;
  }
}

ALIGNGS_TARGET_CLONES
void keep_best_row(int count, float* scores, float* best) {
  float* __restrict s = scores;
  float* __restrict b = best;
  for (int i = 0; i < count; ++i) {
    const float score = s[i], before = b[i];
    b[i] = score > before ? score : before;
    s[i] = score > before ? before : score;
  }
}

ALIGNGS_TARGET_CLONES
void add_scores(int count, const float* scores, float none, double* sums, double* counts) {
  const float* __restrict in = scores;
  double* __restrict sum = sums;
  double* __restrict number = counts;
  for (int i = 0; i < count; ++i) {
    const bool some = in[i] != none;
    sum[i] += static_cast<double>(some ? in[i] : 0.0f);
    number[i] += some ? 1.0 : 0.0;
  }
}

ALIGNGS_TARGET_CLONES
void cost_row(int count, const double* sums, const double* counts, float unknown, float* costs, uint8_t* known) {
  const double* __restrict sum = sums;
  const double* __restrict number = counts;
  float* __restrict out = costs;
  for (int i = 0; i < count; ++i) {
    const float cost = static_cast<float>(1 - sum[i] / number[i]);
    out[i] = number[i] > 0 ? cost : unknown;
  }
  for (int i = 0; i < count; ++i) known[i] = counts[i] > 0 ? 1 : known[i];
}

void transpose_costs(const float* in, size_t rows, size_t columns, float* out) {
  constexpr size_t kBlock = 64;  // columns at a time: their cache lines on both sides stay near
  for (size_t first = 0; first < columns; first += kBlock) {
    const size_t end = std::min(columns, first + kBlock);
    for (size_t r = 0; r < rows; ++r) {
      for (size_t c = first; c < end; ++c) out[c * rows + r] = in[r * columns + c];
    }
  }
}

}  // namespace aligngs
