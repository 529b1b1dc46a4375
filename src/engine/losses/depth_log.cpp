#include "engine/losses/depth_log.h"

#include <algorithm>
#include <cmath>

#include "engine/losses/depth_map.h"
#include "engine/losses/row_parallel.h"

namespace aligngs {
namespace {

constexpr double kHuberMinimum = 1e-9;  // log units: a delta of 0 means the absolute value

}  // namespace

template <class T>
double log_depth_loss(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace) {
  if (in.view.data.prior_depth.empty()) return 0;
  const int width = in.maps.width, height = in.maps.height;
  const double delta = std::max(static_cast<double>(in.settings.log_depth_huber), kHuberMinimum);
  const T scale = static_cast<T>(in.settings.prior_depth_scale);
  if (!(scale > T(0))) return 0;
  // Weight of a pixel, 0 where it does not take part.
  const auto weight_at = [&](size_t i) -> double {
    if (workspace.validity[i] != kDepthTight || !(prior_depth_at(in.view, i) > 0)) return 0;
    return depth_weight_at(in.view, i);
  };

  const auto sums = sum_rows<2>(in.pool, height, workspace.row_sums, [&](int y) {
    std::array<double, 2> s{};
    const size_t begin = static_cast<size_t>(y) * width;
    for (size_t i = begin; i < begin + width; ++i) {
      const double w = weight_at(i);
      s[0] += w > 0 ? 1 : 0;
      s[1] += w;
    }
    return s;
  });
  if (sums[0] < 1 || sums[0] < kMinimumValidShare * static_cast<double>(in.maps.pixels())) return 0;
  const double normalisation = 1 / sums[1];

  return normalisation * sum_rows<1>(in.pool, height, workspace.row_sums, [&](int y) {
           double sum = 0;
           const size_t begin = static_cast<size_t>(y) * width;
           for (size_t i = begin; i < begin + width; ++i) {
             const double w = weight_at(i);
             if (!(w > 0)) continue;
             const T z = workspace.depth[i];
             const double e = static_cast<double>(std::log(z / (scale * static_cast<T>(prior_depth_at(in.view, i)))));
             const double near = std::min(std::max(e, -delta), delta);  // h = near (e - near / 2) / delta
             sum += w * near * (e - near / 2) / delta;
             workspace.depth_gradient[i] += static_cast<T>(weight * normalisation * w * near / delta) / z;
           }
           return std::array<double, 1>{sum};
         })[0];
}

template double log_depth_loss<float>(const MapLossInputs<float>&, double, MapLossWorkspace<float>&);
template double log_depth_loss<double>(const MapLossInputs<double>&, double, MapLossWorkspace<double>&);

}  // namespace aligngs
