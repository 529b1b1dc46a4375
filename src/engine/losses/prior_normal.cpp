#include "engine/losses/prior_normal.h"

#include "engine/losses/row_parallel.h"
#include "engine/losses/unit_normal.h"

namespace aligngs {

template <class T>
double prior_normal_loss(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace,
                         MapGradients<T>& gradients) {
  if (in.view.prior_normal.empty()) return 0;
  const int width = in.maps.width, height = in.maps.height;
  const size_t pixels = in.maps.pixels();
  // Calls use(pixel, weight, blended, prior) for every pixel of row y that takes part.
  const auto for_each_used = [&](int y, const auto& use) {
    const size_t begin = static_cast<size_t>(y) * width;
    for (size_t i = begin; i < begin + width; ++i) {
      const float w = depth_weight_at(in.view, i);
      if (!(w > 0)) continue;
      const Vec3<T> prior = prior_normal_at<T>(in.view, i);
      if (dot(prior, prior) == T(0)) continue;
      const UnitNormal<T> blended = unit_normal_at(workspace, i);
      if (blended.valid()) use(i, static_cast<double>(w), blended, prior);
    }
  };
  const auto sums = sum_rows<3>(in.pool, height, workspace.row_sums, [&](int y) {
    std::array<double, 3> s{};
    for_each_used(y, [&](size_t, double w, const UnitNormal<T>& blended, const Vec3<T>& prior) {
      s[0] += 1;
      s[1] += w;
      s[2] += w * (1 - static_cast<double>(dot(blended.direction, prior)));
    });
    return s;
  });
  if (sums[0] < 1 || sums[0] < kMinimumValidShare * static_cast<double>(pixels)) return 0;
  const double step = -weight / sums[1];
  for_each_row(in.pool, height, [&](int y) {
    for_each_used(y, [&](size_t i, double w, const UnitNormal<T>& blended, const Vec3<T>& prior) {
      add_normal_gradient(blended, prior * static_cast<T>(step * w), i, pixels, gradients);
    });
  });
  return sums[2] / sums[1];
}

template double prior_normal_loss<float>(const MapLossInputs<float>&, double, MapLossWorkspace<float>&,
                                         MapGradients<float>&);
template double prior_normal_loss<double>(const MapLossInputs<double>&, double, MapLossWorkspace<double>&,
                                          MapGradients<double>&);

}  // namespace aligngs
