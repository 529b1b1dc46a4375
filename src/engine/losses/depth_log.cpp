#include "engine/losses/depth_log.h"

#include <algorithm>

#include "engine/losses/depth_map.h"
#include "core/function_versions.h"
#include "engine/losses/ordered_sum.h"
#include "engine/losses/row_parallel.h"

namespace aligngs {
namespace {

// One row of the inputs. Weights are 0 where a pixel does not take part.
struct LogDepthRow {
  const uint8_t* validity;
  const float *prior, *weight;  // weight: nullptr = 1 everywhere
  int width;
};

ALIGNGS_ALWAYS_INLINE void weights_of_row(const LogDepthRow& row, float* __restrict weights) {
  if (row.weight == nullptr) {
    for (int x = 0; x < row.width; ++x) weights[x] = log_depth_weight(row.validity[x], row.prior[x], 1.0f);
  } else {
    for (int x = 0; x < row.width; ++x) {
      weights[x] = log_depth_weight(row.validity[x], row.prior[x], row.weight[x]);
    }
  }
}

// The terms of a row times their weights, and step / z times their slopes added to the gradient.
template <class T>
ALIGNGS_ALWAYS_INLINE void terms_of_row(const T* __restrict depth, const float* __restrict prior,
                                        const float* __restrict weights, int width, T scale, T delta, T step,
                                        T* __restrict value, T* __restrict gradient) {
  for (int x = 0; x < width; ++x) {
    const LogDepthTerm<T> term = log_depth_term(depth[x], prior[x], weights[x], scale, delta, step);
    value[x] = term.value;
    gradient[x] += term.gradient;
  }
}

ALIGNGS_FUNCTION_VERSIONS
void row_weights(const LogDepthRow& row, float* weights) { weights_of_row(row, weights); }
ALIGNGS_FUNCTION_VERSIONS
void row_terms(const float* depth, const float* prior, const float* weights, int width, float scale, float delta,
               float step, float* value, float* gradient) {
  terms_of_row<float>(depth, prior, weights, width, scale, delta, step, value, gradient);
}
void row_terms(const double* depth, const float* prior, const float* weights, int width, double scale, double delta,
               double step, double* value, double* gradient) {
  terms_of_row<double>(depth, prior, weights, width, scale, delta, step, value, gradient);
}

}  // namespace

template <class T>
double log_depth_loss(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace) {
  if (in.view.data.prior_depth.empty()) return 0;
  const int width = in.maps.width, height = in.maps.height;
  const double delta = std::max(static_cast<double>(in.settings.log_depth_huber), kHuberMinimum);
  const T scale = static_cast<T>(in.settings.prior_depth_scale);
  if (!(scale > T(0))) return 0;
  const float* const prior = in.view.data.prior_depth.data.data();
  const float* const confidence = in.view.depth_weight.empty() ? nullptr : in.view.depth_weight.data.data();
  const auto fill_weights = [&](size_t begin, std::vector<float>& weights) {
    weights.resize(static_cast<size_t>(width));
    row_weights({workspace.validity.data() + begin, prior + begin, confidence != nullptr ? confidence + begin : nullptr,
                 width},
                weights.data());
  };

  const auto sums = sum_rows<2>(in.pool, height, workspace.row_sums, [&](int y) {
    thread_local std::vector<float> weights;
    fill_weights(static_cast<size_t>(y) * width, weights);
    int used = 0;
    for (const float w : weights) used += w > 0 ? 1 : 0;
    return std::array<double, 2>{static_cast<double>(used), ordered_sum(weights.data(), width)};
  });
  if (!enough_valid(sums[0], static_cast<double>(in.maps.pixels()))) return 0;
  const double normalisation = 1 / sums[1];

  return normalisation * sum_rows<1>(in.pool, height, workspace.row_sums, [&](int y) {
           thread_local std::vector<float> weights;
           thread_local std::vector<T> values;
           const size_t begin = static_cast<size_t>(y) * width;
           fill_weights(begin, weights);
           values.resize(static_cast<size_t>(width));
           row_terms(workspace.depth.data() + begin, prior + begin, weights.data(), width, scale,
                     static_cast<T>(delta), static_cast<T>(weight * normalisation), values.data(),
                     workspace.depth_gradient.data() + begin);
           return std::array<double, 1>{ordered_sum(values.data(), width)};
         })[0];
}

template double log_depth_loss<float>(const MapLossInputs<float>&, double, MapLossWorkspace<float>&);
template double log_depth_loss<double>(const MapLossInputs<double>&, double, MapLossWorkspace<double>&);

}  // namespace aligngs
