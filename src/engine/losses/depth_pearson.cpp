#include "engine/losses/depth_pearson.h"

#include <vector>

#include "core/target_clones.h"
#include "engine/losses/depth_map.h"
#include "engine/losses/ordered_sum.h"
#include "engine/losses/row_parallel.h"
#include "engine/losses/terms/pearson.h"

namespace aligngs {
namespace {

// One row of the inputs.
template <class T>
struct PearsonRow {
  const T* depth;
  const uint8_t *validity, *edge;  // edge: nullptr = none
  const float* prior;
  int width;
};

// Depth and prior less their means, and 1 where a pixel takes part; all 0 where it does not.
struct CentredRow {
  std::vector<double> used, rendered, prior, product;
  void resize(int width) {
    for (std::vector<double>* v : {&used, &rendered, &prior, &product}) v->resize(static_cast<size_t>(width));
  }
};

template <class T>
ALIGNGS_ALWAYS_INLINE void centre_row(const PearsonRow<T>& row, double mean_rendered, double mean_prior,
                                      double* __restrict used, double* __restrict rendered, double* __restrict prior) {
  const T* __restrict depth = row.depth;
  const uint8_t* __restrict validity = row.validity;
  const float* __restrict given = row.prior;
  for (int x = 0; x < row.width; ++x) {
    const float value = usable_prior_depth(given[x]);
    const bool takes_part = (int(validity[x]) != kDepthInvalid) & (value > 0);
    used[x] = takes_part ? 1.0 : 0.0;
    rendered[x] = takes_part ? static_cast<double>(depth[x]) - mean_rendered : 0.0;
    prior[x] = takes_part ? static_cast<double>(value) - mean_prior : 0.0;
  }
  if (row.edge == nullptr) return;
  for (int x = 0; x < row.width; ++x) {
    const double inside = row.edge[x] == 0 ? 1.0 : 0.0;
    used[x] *= inside;
    rendered[x] *= inside;
    prior[x] *= inside;
  }
}

// Compiled per instruction set: function versions cannot be templates.
ALIGNGS_TARGET_CLONES
void centre(const PearsonRow<float>& row, double mean_rendered, double mean_prior, double* used, double* rendered,
            double* prior) {
  centre_row<float>(row, mean_rendered, mean_prior, used, rendered, prior);
}
void centre(const PearsonRow<double>& row, double mean_rendered, double mean_prior, double* used, double* rendered,
            double* prior) {
  centre_row<double>(row, mean_rendered, mean_prior, used, rendered, prior);
}
ALIGNGS_TARGET_CLONES
void multiply(const double* a, const double* b, int width, double* __restrict out) {
  for (int x = 0; x < width; ++x) out[x] = a[x] * b[x];
}
ALIGNGS_TARGET_CLONES
void add_gradient(const double* rendered, const double* prior, int width, double along_rendered, double along_prior,
                  float* __restrict gradient) {
  for (int x = 0; x < width; ++x)
    gradient[x] += static_cast<float>(along_rendered * rendered[x] - along_prior * prior[x]);
}
void add_gradient(const double* rendered, const double* prior, int width, double along_rendered, double along_prior,
                  double* __restrict gradient) {
  for (int x = 0; x < width; ++x) gradient[x] += along_rendered * rendered[x] - along_prior * prior[x];
}

}  // namespace

template <class T>
double pearson_depth_loss(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace) {
  if (!given_inputs(in.view).suffice(row_of(Loss::kPearson).needs)) return 0;
  const int width = in.maps.width, height = in.maps.height;
  const Image<uint8_t>& edge = in.view.label_edge;
  // Row y, less the means.
  const auto centred = [&](int y, double mean_rendered, double mean_prior) -> CentredRow& {
    thread_local CentredRow out;
    out.resize(width);
    const size_t begin = static_cast<size_t>(y) * width;
    centre(PearsonRow<T>{workspace.depth.data() + begin, workspace.validity.data() + begin,
                         edge.empty() ? nullptr : edge.data.data() + begin,
                         in.view.data.prior_depth.data.data() + begin, width},
           mean_rendered, mean_prior, out.used.data(), out.rendered.data(), out.prior.data());
    return out;
  };

  const auto [n, sum_rendered, sum_prior] = sum_rows<3>(in.pool, height, workspace.row_sums, [&](int y) {
    const CentredRow& row = centred(y, 0, 0);
    return std::array<double, 3>{ordered_sum(row.used.data(), width), ordered_sum(row.rendered.data(), width),
                                 ordered_sum(row.prior.data(), width)};
  });
  if (!enough_for_pearson(n, static_cast<double>(in.maps.pixels()))) return 0;
  const double mean_rendered = sum_rendered / n, mean_prior = sum_prior / n;

  const auto [rendered_squares, prior_squares, mixed] = sum_rows<3>(in.pool, height, workspace.row_sums, [&](int y) {
    CentredRow& row = centred(y, mean_rendered, mean_prior);
    const auto sum_of = [&](const std::vector<double>& a, const std::vector<double>& b) {
      multiply(a.data(), b.data(), width, row.product.data());
      return ordered_sum(row.product.data(), width);
    };
    return std::array<double, 3>{sum_of(row.rendered, row.rendered), sum_of(row.prior, row.prior),
                                 sum_of(row.rendered, row.prior)};
  });
  const PearsonResult result =
      pearson_result({n, mean_rendered, mean_prior, rendered_squares, prior_squares, mixed}, weight);
  if (result.loss == 0 && result.along_prior == 0) return 0;
  for_each_row(in.pool, height, [&](int y) {
    const CentredRow& row = centred(y, mean_rendered, mean_prior);
    add_gradient(row.rendered.data(), row.prior.data(), width, result.along_rendered, result.along_prior,
                 workspace.depth_gradient.data() + static_cast<size_t>(y) * width);
  });
  return result.loss;
}

template double pearson_depth_loss<float>(const MapLossInputs<float>&, double, MapLossWorkspace<float>&);
template double pearson_depth_loss<double>(const MapLossInputs<double>&, double, MapLossWorkspace<double>&);

}  // namespace aligngs
