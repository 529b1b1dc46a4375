// A pixel term over whole maps on the CPU: row by row, several pixels at a time.
#pragma once

#include <vector>

#include "core/target_clones.h"
#include "engine/formulas/depth_terms.h"
#include "engine/losses/map_losses.h"
#include "engine/losses/ordered_sum.h"
#include "engine/losses/row_parallel.h"
#include "engine/losses/terms/pixel_term.h"

namespace aligngs {

/// One row of the inputs of a pixel term; nullptr: the term does not need it.
template <class T>
struct PixelRow {
  int width = 0;
  const T* depth = nullptr;
  const uint8_t* validity = nullptr;
  const T *n_x = nullptr, *n_y = nullptr, *n_z = nullptr, *inverse_length = nullptr;
  const float* prior_depth = nullptr;
  const float* prior_normal = nullptr;  ///< [width][3]
  const float* confidence = nullptr;    ///< always given
};

/// One row of the outputs: values are written, gradients added to.
template <class T>
struct PixelRowOutputs {
  T* value = nullptr;
  T* by_depth = nullptr;
  T *by_x = nullptr, *by_y = nullptr, *by_z = nullptr;
};

/// The inputs of a term at pixel x of a row. Pointers are parameters of the loops below, so that the compiler knows
/// that none overlap.
template <unsigned kNeeds, class T>
ALIGNGS_ALWAYS_INLINE TermPixel<T> term_pixel(int x, const T* depth, const uint8_t* validity, const T* n_x,
                                              const T* n_y, const T* n_z, const T* inverse_length,
                                              const float* prior_depth, const float* prior_normal,
                                              const float* confidence) {
  TermPixel<T> pixel;
  if constexpr ((kNeeds & kNeedsDepth) != 0) {
    pixel.depth = depth[x];
    pixel.validity = validity[x];
  }
  if constexpr ((kNeeds & kNeedsUnitNormal) != 0) {
    pixel.direction = {n_x[x], n_y[x], n_z[x]};
    pixel.inverse_length = inverse_length[x];
  }
  if constexpr ((kNeeds & kNeedsPriorDepth) != 0) pixel.prior_depth = prior_depth[x];
  if constexpr ((kNeeds & kNeedsPriorNormal) != 0) {
    pixel.prior_normal = {prior_normal[3 * x], prior_normal[3 * x + 1], prior_normal[3 * x + 2]};
  }
  pixel.confidence = confidence[x];
  return pixel;
}

template <unsigned kNeeds, class Term, class T>
ALIGNGS_ALWAYS_INLINE void weights_of_row(const Term& given, const PixelRow<T>& row, T* __restrict weights) {
  const Term term = given;
  const T *depth = row.depth, *n_x = row.n_x, *n_y = row.n_y, *n_z = row.n_z, *inverse_length = row.inverse_length;
  const uint8_t* validity = row.validity;
  const float *prior_depth = row.prior_depth, *prior_normal = row.prior_normal, *confidence = row.confidence;
  for (int x = 0, width = row.width; x < width; ++x) {
    weights[x] = term.weight(
        term_pixel<kNeeds>(x, depth, validity, n_x, n_y, n_z, inverse_length, prior_depth, prior_normal, confidence));
  }
}

template <unsigned kNeeds, class Term, class T>
ALIGNGS_ALWAYS_INLINE void values_loop(const Term term, int width, const T* __restrict depth,
                                       const uint8_t* __restrict validity, const T* __restrict n_x,
                                       const T* __restrict n_y, const T* __restrict n_z,
                                       const T* __restrict inverse_length, const float* __restrict prior_depth,
                                       const float* __restrict prior_normal, const float* __restrict confidence,
                                       const T* __restrict weights, T step, T* __restrict value, T* __restrict by_depth,
                                       T* __restrict by_x, T* __restrict by_y, T* __restrict by_z) {
  for (int x = 0; x < width; ++x) {
    const TermValue<T> v = term.at(
        term_pixel<kNeeds>(x, depth, validity, n_x, n_y, n_z, inverse_length, prior_depth, prior_normal, confidence),
        weights[x], step);
    value[x] = v.value;
    if constexpr ((kNeeds & kNeedsDepth) != 0) by_depth[x] += v.by_depth;
    if constexpr ((kNeeds & kNeedsUnitNormal) != 0) {
      by_x[x] += v.by_normal.x;
      by_y[x] += v.by_normal.y;
      by_z[x] += v.by_normal.z;
    }
  }
}
template <unsigned kNeeds, class Term, class T>
ALIGNGS_ALWAYS_INLINE void values_of_row(const Term& term, const PixelRow<T>& row, const T* weights, T step,
                                         const PixelRowOutputs<T>& out) {
  values_loop<kNeeds>(term, row.width, row.depth, row.validity, row.n_x, row.n_y, row.n_z, row.inverse_length,
                      row.prior_depth, row.prior_normal, row.confidence, weights, step, out.value, out.by_depth,
                      out.by_x, out.by_y, out.by_z);
}

/// The weighted mean of a term over the pixels that take part; 0 with fewer than 1 % of them (enough_valid). Adds
/// `weight` times its gradient to workspace.depth_gradient and gradients.normal. `needs`: LossNeeds of the term.
/// row_weights(row, weights) and row_values(row, weights, step, outputs) are its two loops.
template <class T, class RowWeights, class RowValues>
double fold_pixel_term(const MapLossInputs<T>& in, double weight, unsigned needs, const RowWeights& row_weights,
                       const RowValues& row_values, MapLossWorkspace<T>& workspace, MapGradients<T>& gradients) {
  if (!given_inputs(in.view).suffice(needs)) return 0;
  const int width = in.maps.width, height = in.maps.height;
  const size_t pixels = in.maps.pixels();
  const std::vector<float> ones(in.view.depth_weight.empty() ? static_cast<size_t>(width) : 0, 1.0f);
  const auto row_at = [&](size_t begin) {
    PixelRow<T> row;
    row.width = width;
    if ((needs & kNeedsDepth) != 0) {
      row.depth = workspace.depth.data() + begin;
      row.validity = workspace.validity.data() + begin;
    }
    if ((needs & kNeedsUnitNormal) != 0) {
      row.n_x = workspace.direction.data() + begin;
      row.n_y = row.n_x + pixels;
      row.n_z = row.n_y + pixels;
      row.inverse_length = workspace.inverse_length.data() + begin;
    }
    if ((needs & kNeedsPriorDepth) != 0) row.prior_depth = in.view.data.prior_depth.data.data() + begin;
    if ((needs & kNeedsPriorNormal) != 0) row.prior_normal = in.view.prior_normal.data.data() + 3 * begin;
    row.confidence = ones.empty() ? in.view.depth_weight.data.data() + begin : ones.data();
    return row;
  };
  const auto fill_weights = [&](const PixelRow<T>& row, std::vector<T>& weights) {
    weights.resize(static_cast<size_t>(width));
    row_weights(row, weights.data());
  };
  const auto [used, total_weight] = sum_rows<2>(in.pool, height, workspace.row_sums, [&](int y) {
    thread_local std::vector<T> weights;
    fill_weights(row_at(static_cast<size_t>(y) * width), weights);
    int positive = 0;
    for (const T w : weights) positive += w > T(0) ? 1 : 0;
    return std::array<double, 2>{static_cast<double>(positive), ordered_sum(weights.data(), width)};
  });
  if (!enough_valid(used, static_cast<double>(pixels))) return 0;
  const T step = static_cast<T>(weight / total_weight);
  const double value = sum_rows<1>(in.pool, height, workspace.row_sums, [&](int y) {
    thread_local std::vector<T> weights, values;
    const size_t begin = static_cast<size_t>(y) * width;
    const PixelRow<T> row = row_at(begin);
    fill_weights(row, weights);
    values.resize(static_cast<size_t>(width));
    PixelRowOutputs<T> out;
    out.value = values.data();
    if ((needs & kNeedsDepth) != 0) out.by_depth = workspace.depth_gradient.data() + begin;
    if ((needs & kNeedsUnitNormal) != 0) {
      out.by_x = gradients.normal.data() + begin;
      out.by_y = out.by_x + pixels;
      out.by_z = out.by_y + pixels;
    }
    row_values(row, weights.data(), step, out);
    return std::array<double, 1>{ordered_sum(values.data(), width)};
  })[0];
  return value / total_weight;
}

}  // namespace aligngs
