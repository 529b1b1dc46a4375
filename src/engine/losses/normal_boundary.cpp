#include "engine/losses/normal_boundary.h"

#include "engine/losses/label_pairs.h"
#include "engine/losses/row_parallel.h"
#include "engine/losses/unit_normal.h"

namespace aligngs {

template <class T>
double normal_boundary_loss(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace,
                            MapGradients<T>& gradients) {
  const Image<uint16_t>& labels = in.view.data.labels;
  if (!given_inputs(in.view).suffice(row_of(Loss::kNormalBoundary).needs)) return 0;
  const int width = in.maps.width, height = in.maps.height;
  const size_t pixels = in.maps.pixels();
  // Calls use(first pixel, second pixel, first normal, second normal) for every pair of row y.
  const auto for_each_pair = [&](int y, const auto& use) {
    for_each_label_pair(labels, y, [&](const LabelPair& pair) {
      const size_t u = static_cast<size_t>(pair.y) * width + pair.x;
      const size_t v = static_cast<size_t>(pair.y + pair.dy) * width + pair.x + pair.dx;
      if (!in.settings.paper_normals) {
        if (!unbroken_depth(workspace.depth[u], workspace.validity[u], workspace.depth[v], workspace.validity[v])) {
          return;
        }
      }
      const UnitNormal<T> a = unit_normal_at(workspace, u), b = unit_normal_at(workspace, v);
      if (a.valid() && b.valid()) use(u, v, a, b);
    });
  };
  const auto [pairs, total] = sum_rows<2>(in.pool, height, workspace.row_sums, [&](int y) {
    double count = 0, penalty = 0;
    for_each_pair(y, [&](size_t, size_t, const UnitNormal<T>& a, const UnitNormal<T>& b) {
      count += 1;
      penalty += boundary_penalty(static_cast<double>(dot(a.direction, b.direction)));
    });
    return std::array<double, 2>{count, penalty};
  });
  if (pairs < 1) return 0;
  const double step = weight / pairs;
  for_each_row_scattering(in.pool, height, [&](int y) {
    for_each_pair(y, [&](size_t u, size_t v, const UnitNormal<T>& a, const UnitNormal<T>& b) {
      const double l = boundary_penalty(static_cast<double>(dot(a.direction, b.direction)));
      const T slope = static_cast<T>(step * boundary_slope(l));
      add_normal_gradient(a, b.direction * slope, u, pixels, gradients);
      add_normal_gradient(b, a.direction * slope, v, pixels, gradients);
    });
  });
  return total / pairs;
}

template double normal_boundary_loss<float>(const MapLossInputs<float>&, double, MapLossWorkspace<float>&,
                                            MapGradients<float>&);
template double normal_boundary_loss<double>(const MapLossInputs<double>&, double, MapLossWorkspace<double>&,
                                             MapGradients<double>&);

}  // namespace aligngs
