#include "engine/losses/depth_pearson.h"

#include "engine/losses/depth_map.h"
#include "engine/losses/row_parallel.h"

namespace aligngs {

template <class T>
double pearson_depth_loss(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace) {
  if (in.view.data.prior_depth.empty()) return 0;
  const int width = in.maps.width, height = in.maps.height;
  const Image<uint8_t>& edge = in.view.label_edge;
  // Calls use(pixel, rendered, prior) for every pixel of the correlation in row y.
  const auto for_each_used = [&](int y, const auto& use) {
    const size_t begin = static_cast<size_t>(y) * width;
    for (size_t i = begin; i < begin + width; ++i) {
      if (workspace.validity[i] == kDepthInvalid || (!edge.empty() && edge.data[i] != 0)) continue;
      const float prior = prior_depth_at(in.view, i);
      if (prior > 0) use(i, static_cast<double>(workspace.depth[i]), static_cast<double>(prior));
    }
  };

  const auto sums = sum_rows<3>(in.pool, height, workspace.row_sums, [&](int y) {
    std::array<double, 3> s{};
    for_each_used(y, [&](size_t, double rendered, double prior) {
      s[0] += 1;
      s[1] += rendered;
      s[2] += prior;
    });
    return s;
  });
  const double n = sums[0];
  if (!enough_for_pearson(n, static_cast<double>(in.maps.pixels()))) return 0;
  const double mean_rendered = sums[1] / n, mean_prior = sums[2] / n;

  const auto products = sum_rows<3>(in.pool, height, workspace.row_sums, [&](int y) {
    std::array<double, 3> s{};
    for_each_used(y, [&](size_t, double rendered, double prior) {
      const double a = rendered - mean_rendered, b = prior - mean_prior;
      s[0] += a * a;
      s[1] += b * b;
      s[2] += a * b;
    });
    return s;
  });
  const PearsonResult result =
      pearson_result({n, mean_rendered, mean_prior, products[0], products[1], products[2]}, weight);
  if (result.loss == 0 && result.along_prior == 0) return 0;
  for_each_row(in.pool, height, [&](int y) {
    for_each_used(y, [&](size_t i, double rendered, double prior) {
      workspace.depth_gradient[i] += static_cast<T>(result.along_rendered * (rendered - mean_rendered) -
                                                    result.along_prior * (prior - mean_prior));
    });
  });
  return result.loss;
}

template double pearson_depth_loss<float>(const MapLossInputs<float>&, double, MapLossWorkspace<float>&);
template double pearson_depth_loss<double>(const MapLossInputs<double>&, double, MapLossWorkspace<double>&);

}  // namespace aligngs
