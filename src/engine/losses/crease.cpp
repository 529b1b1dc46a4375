#include "engine/losses/crease.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "engine/losses/label_pairs.h"
#include "engine/losses/row_parallel.h"
#include "engine/losses/unit_normal.h"

namespace aligngs {
namespace {

bool same_label_out_to(const Image<uint16_t>& labels, int x, int y, int dx, int dy, int steps) {
  const int last_x = x + steps * dx, last_y = y + steps * dy;
  if (last_x < 0 || last_y < 0 || last_x >= labels.width || last_y >= labels.height) return false;
  for (int k = 1; k <= steps; ++k) {
    if (labels.at(x + k * dx, y + k * dy) != labels.at(x, y)) return false;
  }
  return true;
}

}  // namespace

EdgePrior prior_at_edge(const TrainingView& view, const LabelPair& p) {
  const Image<uint16_t>& labels = view.data.labels;
  const int out = kCreasePriorOffset - 1;  // the first and second pixel are the first beside the edge
  const int x1 = p.x + p.dx, y1 = p.y + p.dy;
  if (!same_label_out_to(labels, p.x, p.y, -p.dx, -p.dy, out)) return {};
  if (!same_label_out_to(labels, x1, y1, p.dx, p.dy, out)) return {};
  const int bx = p.x - out * p.dx, by = p.y - out * p.dy, ax = x1 + out * p.dx, ay = y1 + out * p.dy;
  const size_t before = static_cast<size_t>(by) * labels.width + bx;
  const size_t after = static_cast<size_t>(ay) * labels.width + ax;
  EdgePrior prior;
  prior.weight = std::min(depth_weight_at(view, before), depth_weight_at(view, after));
  prior.before = prior_normal_at<double>(view, before);
  prior.after = prior_normal_at<double>(view, after);
  const double z_before = prior_depth_at(view, before), z_after = prior_depth_at(view, after);
  if (!(prior.weight > 0) || !(z_before > 0) || !(z_after > 0)) return {};
  const Camera& camera = view.data.camera;
  prior.kind = classify_edge(prior.before, camera.ray(bx + 0.5, by + 0.5) * z_before, prior.after,
                             camera.ray(ax + 0.5, ay + 0.5) * z_after,
                             camera.ray(p.x + 0.5 + 0.5 * p.dx, p.y + 0.5 + 0.5 * p.dy));
  return prior;
}

EdgeKind classify_edge(const Vec3d& normal_before, const Vec3d& point_before, const Vec3d& normal_after,
                       const Vec3d& point_after, const Vec3d& edge_ray) {
  const double z_before = dot(normal_before, point_before) / dot(normal_before, edge_ray);
  const double z_after = dot(normal_after, point_after) / dot(normal_after, edge_ray);
  if (!(z_before > 0) || !(z_after > 0)) return EdgeKind::kNothing;
  const double jump = std::abs(z_before - z_after) / std::min(z_before, z_after);
  const double cosine = dot(normal_before, normal_after);
  if (cosine < std::cos(kCreaseAngleDegrees * kRadiansPerDegree) && jump < kCreaseJumpShare) return EdgeKind::kCrease;
  if (cosine > std::cos(kCoplanarAngleDegrees * kRadiansPerDegree) && jump < kCoplanarJumpShare)
    return EdgeKind::kCoplanar;
  return EdgeKind::kNothing;
}

template <class T>
double crease_loss(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace,
                   MapGradients<T>& gradients) {
  const TrainingView& view = in.view;
  if (!given_inputs(view).suffice(row_of(Loss::kCrease).needs)) return 0;
  const int width = in.maps.width, height = in.maps.height;
  const size_t pixels = in.maps.pixels();
  const int out = kCreaseRenderOffset - 1;
  // Calls crease(pixel, normal, prior normal, weight) and coplanar(u, v, n_u, n_v, weight) for the edges of row y.
  const auto for_each_term = [&](int y, const auto& crease, const auto& coplanar) {
    for_each_label_pair(view.data.labels, y, [&](const LabelPair& p) {
      const EdgePrior prior = prior_at_edge(view, p);
      if (prior.kind == EdgeKind::kNothing) return;
      const int reach = prior.kind == EdgeKind::kCrease ? out : 0;
      const size_t u = static_cast<size_t>(p.y - reach * p.dy) * width + (p.x - reach * p.dx);
      const size_t v = static_cast<size_t>(p.y + (1 + reach) * p.dy) * width + (p.x + (1 + reach) * p.dx);
      const UnitNormal<T> n_u = unit_normal_at(workspace, u), n_v = unit_normal_at(workspace, v);
      if (prior.kind == EdgeKind::kCrease) {
        if (n_u.valid()) crease(u, n_u, prior.before.cast<T>(), prior.weight);
        if (n_v.valid()) crease(v, n_v, prior.after.cast<T>(), prior.weight);
      } else if (n_u.valid() && n_v.valid()) {
        coplanar(u, v, n_u, n_v, prior.weight);
      }
    });
  };
  const auto [total_weight, total] = sum_rows<2>(in.pool, height, workspace.row_sums, [&](int y) {
    double weights = 0, misfit = 0;
    const auto add = [&](double w, T cosine) {
      weights += w;
      misfit += w * (1 - static_cast<double>(cosine));
    };
    for_each_term(
        y, [&](size_t, const UnitNormal<T>& n, const Vec3<T>& prior, double w) { add(w, dot(n.direction, prior)); },
        [&](size_t, size_t, const UnitNormal<T>& a, const UnitNormal<T>& b, double w) {
          add(w, dot(a.direction, b.direction));
        });
    return std::array<double, 2>{weights, misfit};
  });
  if (!(total_weight > 0)) return 0;
  const double divisor = std::max(total_weight, kCreaseMinimumShare * static_cast<double>(pixels));
  const double step = -weight / divisor;
  for_each_row_scattering(in.pool, height, [&](int y) {
    for_each_term(
        y,
        [&](size_t i, const UnitNormal<T>& n, const Vec3<T>& prior, double w) {
          add_normal_gradient(n, prior * static_cast<T>(step * w), i, pixels, gradients);
        },
        [&](size_t u, size_t v, const UnitNormal<T>& a, const UnitNormal<T>& b, double w) {
          add_normal_gradient(a, b.direction * static_cast<T>(step * w), u, pixels, gradients);
          add_normal_gradient(b, a.direction * static_cast<T>(step * w), v, pixels, gradients);
        });
  });
  return total / divisor;
}

template double crease_loss<float>(const MapLossInputs<float>&, double, MapLossWorkspace<float>&, MapGradients<float>&);
template double crease_loss<double>(const MapLossInputs<double>&, double, MapLossWorkspace<double>&,
                                    MapGradients<double>&);

}  // namespace aligngs
