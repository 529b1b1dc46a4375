// Steps of stereo_sweep.h for one row of pixels after the other; each compiled for several instruction sets.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/vec.h"

namespace aligngs {

/// Sums of one pixel or of a window: how many count, this photo's luma and the other's, their squares, their product.
struct WindowTerms {
  float *count, *own, *own2, *other, *other2, *product;
};

/// Another photo, and this one's pixels as points in its camera's frame: factor * direction + origin.
struct WarpedRow {
  const float *x, *y, *z;  ///< directions
  Vec3f origin;
  float factor = 1;
  const float* depth;  ///< of this photo; a pixel without it does not count
  const float* own;    ///< luma of this photo, about zero
  const float* luma;   ///< of the other photo, width x height, both at least 2
  int width = 0, height = 0;
  float fx = 1, fy = 1, cx = 0, cy = 0;  ///< of the other camera; its pixel centres lie at whole numbers here
  float middle = 0;                      ///< taken off the other photo's luma
};

/// Terms of `count` pixels; zeros where a pixel falls outside of the other photo or behind its camera.
void warp_row(const WarpedRow& row, int count, const WindowTerms& out);

/// out[x] = rows[0][x] + rows[1][x] + ..., `terms` of them in this order, for 0 <= x < count. These are sums over the rows
/// of windows. Rows that are one row, shifted, give sums over their columns.
void sum_rows(const float* const* rows, int terms, int count, float* out);

struct ScoreRule {
  float least_count;     ///< of a window's pixels
  float least_variance;  ///< of this photo's luma in it
  float none;            ///< the score where nothing can be said
};

/// Normalised cross-correlation in [-1, 1] from sums over windows; 0 where the other photo is flat. A pixel that does
/// not count itself (pixel_count 0) has none.
void score_row(const WindowTerms& sums, const float* pixel_count, const ScoreRule& rule, int count, float* scores);

/// The larger of both goes to best, the smaller stays in scores.
void keep_best_row(int count, float* scores, float* best);

/// Adds the scores that are not `none`, and counts them.
void add_scores(int count, const float* scores, float none, double* sums, double* counts);

/// One minus the mean of the scores, or `unknown` without any; known[x] becomes 1 with one.
void cost_row(int count, const double* sums, const double* counts, float unknown, float* costs, uint8_t* known);

/// Turns [rows][columns] into [columns][rows].
void transpose_costs(const float* in, size_t rows, size_t columns, float* out);

}  // namespace aligngs
