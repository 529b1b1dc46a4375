// The specification of one training step's gradient: maps, losses and the way back to every parameter, for one view.
#pragma once

#include <cmath>
#include <functional>

#include "engine/formulas/shape_terms.h"
#include "engine/losses/map_losses.h"
#include "engine/reference/reference_semantics.h"

namespace aligngs::reference {

/// Adds terms (unweighted; `total` weighted) and weighted gradients of the maps. By default engine/losses does this;
/// tests put a probe here.
template <class T>
using MapLossFunction = std::function<void(const RenderMaps<T>&, LossTerms&, MapGradients<T>&)>;

template <class T>
struct Gradients {
  LossTerms losses;            ///< `total` is the weighted sum of the terms; the coupling surrogate is not in it
  GaussianModelT<T> gradient;  ///< d total / d parameters, plus coupling_scale * coupling
  /// The semantic gradient through the blending weights before coupling_scale: position, log-scale, rotation,
  /// opacity. With kPlain the gradient of the semantic loss as printed, otherwise that of coupling_value.
  GaussianModelT<T> coupling;
  double coupling_scale = 0;  ///< kPlain: the strength; otherwise the factor that was passed in
  double coupling_value = 0;  ///< the surrogate L_geo, mean over valid pixels; kPlain: 0
  /// d / d mean2D in pixels, per row: of the colour losses, the same with every pixel's magnitude, of the coupling
  /// before the scale.
  std::vector<Vec2<T>> photometric_mean, photometric_mean_abs, coupling_mean;
  double photometric_rms = 0, coupling_rms = 0;  ///< of those over visible rows: what CouplingBalance takes
  DensityStatistics statistics;                  ///< this view's contribution alone
  size_t visible = 0;                            ///< rows blended in at least one pixel
  std::vector<uint32_t> non_finite;              ///< rows that were culled; their gradient is zero
};

namespace detail {

template <class T>
GaussianModelT<T> zeros_like(const GaussianModelT<T>& model) {
  GaussianModelT<T> z;
  z.semantic_channels = model.semantic_channels;
  z.sh_degree = model.sh_degree;
  z.resize(model.size());
  return z;
}

/// Adds scale * (gradient of the parameters of row i).
template <class T>
void add_shape(const ShapeGradient<T>& g, T scale, size_t i, GaussianModelT<T>& out) {
  for (int k = 0; k < 3; ++k) out.positions[3 * i + k] += scale * g.position[k];
  for (int k = 0; k < 3; ++k) out.log_scales[3 * i + k] += scale * g.log_scale[k];
  for (int k = 0; k < 4; ++k) out.rotations[4 * i + k] += scale * g.rotation[k];
  out.opacity_logits[i] += scale * g.opacity_logit;
}

/// Terms of the Gaussians themselves; see formulas/shape_terms.h. Rows that are not finite are left out.
template <class T>
void shape_terms(const Splats<T>& s, const std::vector<uint8_t>& touched, size_t visible, const StepRequest& request,
                 LossTerms& terms, GaussianModelT<T>& gradient) {
  const LossSettings& set = request.losses;
  const T extent = T(request.extent);
  const size_t n = s.shapes.size();
  double flatten = 0, opacity = 0, scale = 0;
  for (size_t i = 0; i < n; ++i) {
    const GaussianShape<T>& g = s.shapes[i];
    if (s.projections[i].status == ProjectionStatus::kNonFinite) continue;
    if (set.weight[Loss::kFlatten] != 0 && touched[i]) {
      const T value = flatten_value(g.log_scale, extent);
      flatten += static_cast<double>(value) / visible;
      gradient.log_scales[3 * i + smallest_axis(g.log_scale)] += T(set.weight[Loss::kFlatten]) * value / T(visible);
    }
    if (set.weight[Loss::kOpacityL1] != 0) {
      T derivative;
      opacity += static_cast<double>(opacity_of_logit(g.opacity_logit, derivative)) / n;
      gradient.opacity_logits[i] += T(set.weight[Loss::kOpacityL1]) * derivative / T(n);
    }
    if (set.weight[Loss::kScaleL1] != 0) {
      for (int k = 0; k < 3; ++k) {
        const T value = scale_value(g.log_scale[k], extent);
        scale += static_cast<double>(value) / (3 * n);
        gradient.log_scales[3 * i + k] += T(set.weight[Loss::kScaleL1]) * value / T(3 * n);
      }
    }
  }
  terms.add(Loss::kFlatten, set.weight[Loss::kFlatten], flatten);
  terms.add(Loss::kOpacityL1, set.weight[Loss::kOpacityL1], opacity);
  terms.add(Loss::kScaleL1, set.weight[Loss::kScaleL1], scale);
}

inline double rms_over(size_t visible, double sum_of_squares) {
  return visible > 0 ? std::sqrt(sum_of_squares / static_cast<double>(visible)) : 0.0;
}

/// Sums over the pixels of a view, per row. Three ways into alpha are kept apart: colour (density statistics take it
/// alone), geometry, semantics.
template <class T>
struct PixelSumsOfRows {
  std::vector<ProjectionGradient<T>> by_color, by_geometry, by_semantics;
  std::vector<Vec3<T>> color;     ///< dL / d colour
  std::vector<Vec2<T>> mean_abs;  ///< sum of |dL_photometric / d mean2D|
  std::vector<double> weight, residual, unsupported;
  std::vector<uint8_t> touched;
  explicit PixelSumsOfRows(size_t n)
      : by_color(n),
        by_geometry(n),
        by_semantics(n),
        color(n),
        mean_abs(n),
        weight(n),
        residual(n),
        unsupported(n),
        touched(n) {}
};

/// Mean absolute colour difference of a pixel; 0 where the mask leaves it out.
template <class T>
double color_residual_at(const RenderMaps<T>& maps, const TrainingView& view, int x, int y) {
  if (view.data.color.empty() || (!view.data.mask.empty() && !(view.data.mask.at(x, y) > 0.5f))) return 0;
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const double rendered = static_cast<double>(maps.color[c * maps.pixels() + size_t(y) * maps.width + x]);
    sum += std::abs(rendered - view.data.color.at(x, y, c)) / 3;
  }
  return sum;
}

/// The prior depth of a pixel in this step's scale, 0 = none.
template <class T>
T prior_depth_of(const TrainingView& view, const LossSettings& settings, int x, int y) {
  return view.data.prior_depth.empty() ? T(0) : T(view.data.prior_depth.at(x, y)) * T(settings.prior_depth_scale);
}

/// The way back through one pixel: from the gradients of its maps to the projections, colours and rows.
template <class T>
void backward_pixel(const Splats<T>& s, const RenderMaps<T>& maps, const MapGradients<T>& dmap,
                    const TrainingView& view, const StepRequest& request, int x, int y, SemanticsOfView<T>& semantics,
                    std::vector<Contribution<T>>& list, PixelSumsOfRows<T>& sums) {
  const RasterSettings& raster = request.raster;
  const size_t pixels = maps.pixels(), u = size_t(y) * maps.width + x;
  const Vec3<T> gcolor{dmap.color[u], dmap.color[pixels + u], dmap.color[2 * pixels + u]};
  const Vec3<T> gnormal{dmap.normal[u], dmap.normal[pixels + u], dmap.normal[2 * pixels + u]};
  T left = T(1);
  blend_pixel(s, x, y, raster, list, left);
  const SemanticPixel<T> semantic = semantics.visit(x, y, list, maps.alpha[u]);

  // q_k = v_k . g for the three kinds of values, then their totals (see AlphaSweep).
  const auto q_color = [&](uint32_t row) { return dot(s.colors[row], gcolor); };
  const auto q_geometry = [&](uint32_t row) {
    return dot(s.projections[row].normal, gnormal) + s.projections[row].distance * dmap.distance[u] + dmap.alpha[u];
  };
  const auto q_semantic = [&](uint32_t row) { return semantics.coupling_of(semantic, row); };
  AlphaSweep<T> by_color, by_geometry, by_semantics;
  for (const Contribution<T>& k : list) {
    by_color.total += k.weight * q_color(k.row);
    by_geometry.total += k.weight * q_geometry(k.row);
    by_semantics.total += k.weight * q_semantic(k.row);
  }
  for (int c = 0; c < 3; ++c) by_color.total += left * T(raster.background[c]) * gcolor[c];

  const double residual = color_residual_at(maps, view, x, y);
  const T prior = prior_depth_of<T>(view, request.losses, x, y);
  for (const Contribution<T>& k : list) {
    const uint32_t i = k.row;
    const Projection<T>& p = s.projections[i];
    const auto next = [&](AlphaSweep<T>& sweep, T q) {
      return sweep.next(k.sample.alpha, k.transmittance, k.weight, q);
    };
    const Vec2<T> dmean = alpha_backward(k.sample, p.conic, p.opacity, next(by_color, q_color(i)), sums.by_color[i]);
    alpha_backward(k.sample, p.conic, p.opacity, next(by_geometry, q_geometry(i)), sums.by_geometry[i]);
    alpha_backward(k.sample, p.conic, p.opacity, next(by_semantics, q_semantic(i)), sums.by_semantics[i]);
    sums.color[i] += k.weight * gcolor;
    sums.by_geometry[i].normal += k.weight * gnormal;
    sums.by_geometry[i].distance += k.weight * dmap.distance[u];

    sums.touched[i] = 1;
    sums.mean_abs[i].x += std::abs(dmean.x);
    sums.mean_abs[i].y += std::abs(dmean.y);
    sums.weight[i] += static_cast<double>(k.weight);
    sums.residual[i] += static_cast<double>(k.weight) * residual;
    if (prior_unsupported(prior, intersection_depth(p, s.camera.ray(x, y)))) {
      sums.unsupported[i] += static_cast<double>(k.weight);
    }
  }
}

/// This view's contribution to DensityStatistics; rows that touched nothing stay zero.
template <class T>
DensityStatistics density_contribution(const Splats<T>& s, const PixelSumsOfRows<T>& sums) {
  const size_t n = sums.touched.size();
  const double to_ndc_x = 0.5 * s.camera.width, to_ndc_y = 0.5 * s.camera.height;
  DensityStatistics d;
  for (std::vector<float>* field :
       {&d.gradient, &d.gradient_abs, &d.visible, &d.radius, &d.weight, &d.residual, &d.unsupported}) {
    field->assign(n, 0.0f);
  }
  for (size_t i = 0; i < n; ++i) {
    if (!sums.touched[i]) continue;
    const Vec2<T> mean = sums.by_color[i].mean, absolute = sums.mean_abs[i];
    d.gradient[i] = static_cast<float>(std::hypot(mean.x * to_ndc_x, mean.y * to_ndc_y));
    d.gradient_abs[i] = static_cast<float>(std::hypot(absolute.x * to_ndc_x, absolute.y * to_ndc_y));
    d.visible[i] = 1;
    d.radius[i] = static_cast<float>(s.projections[i].radius);
    d.weight[i] = static_cast<float>(sums.weight[i]);
    d.residual[i] = static_cast<float>(sums.residual[i]);
    d.unsupported[i] = static_cast<float>(sums.unsupported[i]);
  }
  return d;
}

/// From projections, colours and blended features to the parameters of every row that touched a pixel.
template <class T>
void to_parameters(const GaussianModelT<T>& model, const Splats<T>& s, const PixelSumsOfRows<T>& sums,
                   const SemanticsOfView<T>& semantics, int sh_degree, Gradients<T>& out) {
  const size_t rows = model.size();
  out.photometric_mean.assign(rows, Vec2<T>());
  out.coupling_mean.assign(rows, Vec2<T>());
  double photometric_square = 0, coupling_square = 0;
  for (size_t i = 0; i < rows; ++i) {
    if (!sums.touched[i]) continue;
    ++out.visible;
    const GaussianShape<T>& g = s.shapes[i];
    const Projection<T>& p = s.projections[i];
    add_shape(project_backward(g, s.camera, p, sums.by_color[i]), T(1), i, out.gradient);
    add_shape(project_backward(g, s.camera, p, sums.by_geometry[i]), T(1), i, out.gradient);
    const ShapeGradient<T> coupled = project_backward(g, s.camera, p, sums.by_semantics[i]);
    add_shape(coupled, T(1), i, out.coupling);
    add_shape(coupled, T(out.coupling_scale), i, out.gradient);
    const size_t first = 3 * kShCoefficients * i;
    const Vec3<T> dposition = sh_color_backward(sh_degree, g.position, s.camera.centre, &model.sh[first], s.colors[i],
                                                sums.color[i], &out.gradient.sh[first]);
    for (int k = 0; k < 3; ++k) out.gradient.positions[3 * i + k] += dposition[k];
    if (semantics.valid > 0) semantics.row_gradient(i, &out.gradient.semantics[i * model.semantic_channels]);

    const Vec2<T> mean = sums.by_color[i].mean, coupling = sums.by_semantics[i].mean;
    out.photometric_mean[i] = mean;
    out.coupling_mean[i] = coupling;
    photometric_square += static_cast<double>(mean.x * mean.x + mean.y * mean.y);
    coupling_square += static_cast<double>(coupling.x * coupling.x + coupling.y * coupling.y);
  }
  out.photometric_rms = rms_over(out.visible, photometric_square);
  out.coupling_rms = rms_over(out.visible, coupling_square);
}

}  // namespace detail

/// Values and gradients of one view. `bounded_scale` is the factor of the bounded coupling (coupling_factor in
/// formulas/semantic_loss.h). An engine keeps the balance; here it is an input. kPlain takes the strength instead.
/// Rates and Adam settings of the request are not used.
template <class T>
Gradients<T> gradients(const GaussianModelT<T>& model, const TrainingView& view, const StepRequest& request,
                       double bounded_scale, const MapLossFunction<T>& map_loss) {
  const LossSettings& set = request.losses;
  const Splats<T> s = make_splats(model, view.data.camera, request.raster, request.sh_degree);
  const RenderMaps<T> maps = render_maps(s, request.raster);

  Gradients<T> out;
  out.non_finite = s.non_finite;
  out.gradient = detail::zeros_like(model);
  out.coupling = detail::zeros_like(model);
  out.coupling_scale = set.coupling == SemanticCoupling::kPlain ? set.coupling_strength : bounded_scale;
  MapGradients<T> dmap;
  dmap.reset(maps.pixels());
  map_loss(maps, out.losses, dmap);

  SemanticsOfView<T> semantics(model, view, set);
  detail::PixelSumsOfRows<T> sums(model.size());
  std::vector<Contribution<T>> list;
  for (int y = 0; y < maps.height; ++y) {
    for (int x = 0; x < maps.width; ++x) {
      detail::backward_pixel(s, maps, dmap, view, request, x, y, semantics, list, sums);
    }
  }
  detail::to_parameters(model, s, sums, semantics, request.sh_degree, out);
  out.photometric_mean_abs = sums.mean_abs;
  out.statistics = detail::density_contribution(s, sums);

  out.losses.add(Loss::kSemanticSoft, set.weight[Loss::kSemanticSoft], semantics.soft);
  out.losses.add(Loss::kSemanticHard, set.weight[Loss::kSemanticHard], semantics.hard);
  out.coupling_value = semantics.surrogate;
  detail::shape_terms(s, sums.touched, out.visible, request, out.losses, out.gradient);
  return out;
}

/// The plane depth of the request's neighbour, as the multi-view terms take it.
template <class T>
std::vector<T> neighbour_depth(const GaussianModelT<T>& model, const TrainingView& neighbour,
                               const StepRequest& request) {
  RasterSettings raster = request.raster;
  raster.near_plane = request.neighbour.near_plane;
  const RenderMaps<T> maps = render_maps(make_splats(model, neighbour.data.camera, raster, request.sh_degree), raster);
  MapLossWorkspace<T> workspace;
  keep_neighbour_depth(MapLossInputs<T>{maps, neighbour, request.losses}, workspace);
  return workspace.neighbour_depth;
}

/// The same with the map losses of engine/losses; nullptr: without multi-view terms.
template <class T>
Gradients<T> gradients(const GaussianModelT<T>& model, const TrainingView& view, const StepRequest& request,
                       double bounded_scale, const NeighbourView<T>* neighbour = nullptr) {
  const MapLossFunction<T> losses = [&](const RenderMaps<T>& maps, LossTerms& terms, MapGradients<T>& dmap) {
    map_losses(MapLossInputs<T>{maps, view, request.losses, nullptr, nullptr, neighbour}, terms, dmap);
  };
  return gradients(model, view, request, bounded_scale, losses);
}

}  // namespace aligngs::reference
