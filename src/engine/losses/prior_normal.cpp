#include "engine/losses/prior_normal.h"

#include <vector>

#include "core/function_versions.h"
#include "engine/losses/ordered_sum.h"
#include "engine/losses/row_parallel.h"
#include "engine/losses/unit_normal.h"

namespace aligngs {
namespace {

// One row; pixel x has its prior at prior[3 x].
template <class T>
struct PriorNormalRow {
  int width = 0;
  const float* prior = nullptr;
  const T *n_x = nullptr, *n_y = nullptr, *n_z = nullptr, *inverse_length = nullptr;
};

// Weights, 0 where a pixel takes no part, and weights times 1 - n . n_prior.
template <class T>
ALIGNGS_ALWAYS_INLINE void terms_of_row(const PriorNormalRow<T>& row, const float* __restrict confidence,
                                        T* __restrict weight, T* __restrict term) {
  const float* __restrict prior = row.prior;
  const T *__restrict n_x = row.n_x, *__restrict n_y = row.n_y, *__restrict n_z = row.n_z;
  const T* __restrict inverse_length = row.inverse_length;
  for (int x = 0; x < row.width; ++x) {
    const PriorNormalTerm<T> t = prior_normal_term<T>({n_x[x], n_y[x], n_z[x]}, inverse_length[x], prior[3 * x],
                                                      prior[3 * x + 1], prior[3 * x + 2], confidence[x]);
    weight[x] = t.weight;
    term[x] = t.value;
  }
}

// Adds step * weight * dL / dN for L = -n . n_prior.
template <class T>
ALIGNGS_ALWAYS_INLINE void gradients_of_row(const PriorNormalRow<T>& row, const T* __restrict weight, T step,
                                            T* __restrict d_x, T* __restrict d_y, T* __restrict d_z) {
  const float* __restrict prior = row.prior;
  const T *__restrict n_x = row.n_x, *__restrict n_y = row.n_y, *__restrict n_z = row.n_z;
  const T* __restrict inverse_length = row.inverse_length;
  for (int x = 0; x < row.width; ++x) {
    const Vec3<T> d = prior_normal_gradient<T>({n_x[x], n_y[x], n_z[x]}, inverse_length[x], prior[3 * x],
                                               prior[3 * x + 1], prior[3 * x + 2], weight[x], step);
    d_x[x] += d.x;
    d_y[x] += d.y;
    d_z[x] += d.z;
  }
}

ALIGNGS_FUNCTION_VERSIONS
void row_terms(const PriorNormalRow<float>& row, const float* confidence, float* weight, float* term) {
  terms_of_row<float>(row, confidence, weight, term);
}
void row_terms(const PriorNormalRow<double>& row, const float* confidence, double* weight, double* term) {
  terms_of_row<double>(row, confidence, weight, term);
}
ALIGNGS_FUNCTION_VERSIONS
void row_gradients(const PriorNormalRow<float>& row, const float* weight, float step, float* d_x, float* d_y,
                   float* d_z) {
  gradients_of_row<float>(row, weight, step, d_x, d_y, d_z);
}
void row_gradients(const PriorNormalRow<double>& row, const double* weight, double step, double* d_x, double* d_y,
                   double* d_z) {
  gradients_of_row<double>(row, weight, step, d_x, d_y, d_z);
}

}  // namespace

template <class T>
double prior_normal_loss(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace,
                         MapGradients<T>& gradients) {
  if (in.view.prior_normal.empty()) return 0;
  const int width = in.maps.width, height = in.maps.height;
  const size_t pixels = in.maps.pixels();
  const std::vector<float> ones(in.view.depth_weight.empty() ? static_cast<size_t>(width) : 0, 1.0f);
  // Fills weights and terms of row y and returns the row.
  const auto prepare = [&](int y, std::vector<T>& weights, std::vector<T>& terms) {
    const size_t begin = static_cast<size_t>(y) * width;
    PriorNormalRow<T> row;
    row.width = width;
    row.prior = in.view.prior_normal.data.data() + 3 * begin;
    row.n_x = workspace.direction.data() + begin;
    row.n_y = row.n_x + pixels;
    row.n_z = row.n_y + pixels;
    row.inverse_length = workspace.inverse_length.data() + begin;
    weights.resize(static_cast<size_t>(width));
    terms.resize(static_cast<size_t>(width));
    row_terms(row, ones.empty() ? in.view.depth_weight.data.data() + begin : ones.data(), weights.data(), terms.data());
    return row;
  };
  const auto sums = sum_rows<3>(in.pool, height, workspace.row_sums, [&](int y) {
    thread_local std::vector<T> weights, terms;
    prepare(y, weights, terms);
    int used = 0;
    for (const T w : weights) used += w > T(0) ? 1 : 0;
    return std::array<double, 3>{static_cast<double>(used), ordered_sum(weights.data(), width),
                                 ordered_sum(terms.data(), width)};
  });
  if (!enough_valid(sums[0], static_cast<double>(pixels))) return 0;
  const T step = static_cast<T>(-weight / sums[1]);
  for_each_row(in.pool, height, [&](int y) {
    thread_local std::vector<T> weights, terms;
    const PriorNormalRow<T> row = prepare(y, weights, terms);
    T* d = gradients.normal.data() + static_cast<size_t>(y) * width;
    row_gradients(row, weights.data(), step, d, d + pixels, d + 2 * pixels);
  });
  return sums[2] / sums[1];
}

template double prior_normal_loss<float>(const MapLossInputs<float>&, double, MapLossWorkspace<float>&,
                                         MapGradients<float>&);
template double prior_normal_loss<double>(const MapLossInputs<double>&, double, MapLossWorkspace<double>&,
                                          MapGradients<double>&);

}  // namespace aligngs
