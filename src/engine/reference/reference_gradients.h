// The specification of one training step's gradient: maps, losses and the way back to every parameter, for one view.
#pragma once

#include <cmath>
#include <functional>

#include "engine/formulas/shape_terms.h"
#include "engine/formulas/teacher_sampling.h"
#include "engine/losses/map_losses.h"
#include "engine/reference/reference_forward.h"

namespace aligngs::reference {

/// Adds terms (unweighted; `total` weighted) and weighted gradients of the maps. By default engine/losses does this;
/// tests put a probe here.
template <class T>
using MapLossFunction = std::function<void(const RenderMaps<T>&, LossTerms&, MapGradients<T>&)>;

template <class T>
struct Gradients {
  LossTerms losses;              ///< `total` is the weighted sum of the terms; the coupling surrogate is not in it
  GaussianModelT<T> gradient;    ///< d total / d parameters, plus coupling_scale * coupling
  /// The semantic gradient through the blending weights before coupling_scale: position, log-scale, rotation,
  /// opacity. With kPlain the gradient of the semantic loss as printed, with kBounded that of coupling_value.
  GaussianModelT<T> coupling;
  double coupling_scale = 0;     ///< kPlain: the strength; kBounded: the factor that was passed in
  double coupling_value = 0;     ///< kBounded: the surrogate L_geo, mean over valid pixels; kPlain: 0
  /// d / d mean2D in pixels, per row: of the colour losses, the same with every pixel's magnitude, of the coupling
  /// before the scale.
  std::vector<Vec2<T>> photometric_mean, photometric_mean_abs, coupling_mean;
  double photometric_rms = 0, coupling_rms = 0;  ///< of those over visible rows: what CouplingBalance takes
  DensityStatistics statistics;  ///< this view's contribution alone
  size_t visible = 0;            ///< rows blended in at least one pixel
  std::vector<uint32_t> non_finite;  ///< rows that were culled; their gradient is zero
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
    if (set.flatten_weight != 0 && touched[i]) {
      const T value = flatten_value(g.log_scale, extent);
      flatten += static_cast<double>(value) / visible;
      gradient.log_scales[3 * i + smallest_axis(g.log_scale)] += T(set.flatten_weight) * value / T(visible);
    }
    if (set.opacity_l1_weight != 0) {
      T derivative;
      opacity += static_cast<double>(opacity_of_logit(g.opacity_logit, derivative)) / n;
      gradient.opacity_logits[i] += T(set.opacity_l1_weight) * derivative / T(n);
    }
    if (set.scale_l1_weight != 0) {
      for (int k = 0; k < 3; ++k) {
        const T value = scale_value(g.log_scale[k], extent);
        scale += static_cast<double>(value) / (3 * n);
        gradient.log_scales[3 * i + k] += T(set.scale_l1_weight) * value / T(3 * n);
      }
    }
  }
  terms.flatten += flatten;
  terms.opacity_l1 += opacity;
  terms.scale_l1 += scale;
  terms.total += set.flatten_weight * flatten + set.opacity_l1_weight * opacity + set.scale_l1_weight * scale;
}

/// The semantic loss at one pixel: values, row gradient g, coupling direction h and offset.
template <class T>
struct SemanticPixel {
  SemanticTerms<T> terms;
  T surrogate{};
  std::vector<T> row_gradient, coupling;
  T offset{};
};

template <class T>
SemanticPixel<T> semantic_pixel(const std::vector<T>& blended, T alpha, const std::vector<T>& teacher,
                                const LossSettings& set, const SemanticWeights<T>& weights, T omega) {
  const int channels = static_cast<int>(blended.size());
  const bool probabilities = set.semantic_blend == SemanticBlend::kProbabilities;
  SemanticPixel<T> out;
  out.row_gradient.resize(channels);
  std::vector<T> student(channels);
  out.terms = probabilities ? semantic_loss_probabilities(blended.data(), alpha, teacher.data(), channels, weights,
                                                          out.row_gradient.data())
                            : semantic_loss_logits(blended.data(), teacher.data(), channels, weights, student.data(),
                                                   out.row_gradient.data());
  if (set.coupling == SemanticCoupling::kPlain) {
    out.coupling = out.row_gradient;
    out.offset = plain_coupling_offset(probabilities, out.row_gradient.data(), channels);
    return out;
  }
  out.coupling.resize(channels);
  out.surrogate =
      probabilities
          ? bounded_coupling_probabilities(blended.data(), alpha, teacher.data(), channels, omega, out.coupling.data())
          : bounded_coupling_logits(student.data(), alpha, teacher.data(), channels, omega, out.coupling.data());
  return out;
}

inline double rms_over(size_t visible, double sum_of_squares) {
  return visible > 0 ? std::sqrt(sum_of_squares / static_cast<double>(visible)) : 0.0;
}

}  // namespace detail

/// Values and gradients of one view. `bounded_scale` is the factor of the bounded coupling (coupling_factor in
/// formulas/semantic_loss.h; an engine keeps the balance, here it is an input); kPlain takes the strength instead.
/// Rates and Adam settings of the request are not used.
template <class T>
Gradients<T> gradients(const GaussianModelT<T>& model, const TrainingView& view, const StepRequest& request,
                       double bounded_scale, const MapLossFunction<T>& map_loss) {
  const LossSettings& set = request.losses;
  const RasterSettings& raster = request.raster;
  const size_t rows = model.size();
  const Splats<T> s = make_splats(model, view.data.camera, raster, request.sh_degree);
  const RenderMaps<T> maps = render_maps(s, raster);
  const size_t pixels = maps.pixels();

  Gradients<T> out;
  out.non_finite = s.non_finite;
  out.gradient = detail::zeros_like(model);
  out.coupling = detail::zeros_like(model);
  MapGradients<T> dmap;
  dmap.reset(pixels);
  map_loss(maps, out.losses, dmap);

  // Semantics: on with a teacher of this model's classes and at least one valid pixel.
  const int channels = model.semantic_channels;
  const SemanticTarget& target = view.data.semantics;
  const bool probabilities = set.semantic_blend == SemanticBlend::kProbabilities;
  size_t valid = 0;
  if (channels > 0 && target.channels == channels && (set.semantic_soft_weight != 0 || set.semantic_hard_weight != 0)) {
    valid = count_semantic_pixels(view.data);
  }
  const std::vector<T> features = valid > 0 ? semantic_features(model, set.semantic_blend) : std::vector<T>();
  std::vector<T> dfeatures(features.size(), T(0));
  std::vector<T> teacher(channels), blended(channels);
  std::vector<float> teacher_row(channels);
  SemanticWeights<T> weights;
  if (valid > 0) weights = {T(set.semantic_soft_weight) / T(valid), T(set.semantic_hard_weight) / T(valid)};
  out.coupling_scale = set.coupling == SemanticCoupling::kPlain ? set.coupling_strength : bounded_scale;

  // Three ways into alpha are kept apart: colour (density statistics take it alone), geometry, semantics.
  std::vector<ProjectionGradient<T>> by_color(rows), by_geometry(rows), by_semantics(rows);
  std::vector<Vec3<T>> dcolor(rows);
  out.photometric_mean_abs.assign(rows, Vec2<T>());
  std::vector<uint8_t> touched(rows, 0);
  for (std::vector<float>* field : {&out.statistics.gradient, &out.statistics.gradient_abs, &out.statistics.visible,
                                    &out.statistics.radius, &out.statistics.weight, &out.statistics.residual,
                                    &out.statistics.unsupported}) {
    field->assign(rows, 0.0f);
  }
  std::vector<double> weight_sum(rows, 0), residual_sum(rows, 0), unsupported_sum(rows, 0);
  double soft = 0, hard = 0, surrogate = 0;

  std::vector<Contribution<T>> list;
  for (int y = 0; y < maps.height; ++y) {
    for (int x = 0; x < maps.width; ++x) {
      const size_t u = size_t(y) * maps.width + x;
      const Vec3<T> ray = s.camera.ray(x, y);
      T left = T(1);
      blend_pixel(s, x, y, raster, list, left);

      const Vec3<T> gcolor{dmap.color[u], dmap.color[pixels + u], dmap.color[2 * pixels + u]};
      const Vec3<T> gnormal{dmap.normal[u], dmap.normal[pixels + u], dmap.normal[2 * pixels + u]};
      const T gdistance = dmap.distance[u], galpha = dmap.alpha[u];

      // The semantic loss of this pixel.
      const bool speaks = valid > 0;
      const TeacherTaps taps = speaks ? teacher_taps(target, x, y, maps.width, maps.height) : TeacherTaps();
      const bool semantic = speaks && semantic_pixel_valid(view.data, taps, x, y);
      detail::SemanticPixel<T> sem;
      if (semantic) {
        sample_teacher(target, taps, teacher_row.data());
        std::fill(blended.begin(), blended.end(), T(0));
        for (int c = 0; c < channels; ++c) teacher[c] = T(teacher_row[c]);
        for (const Contribution<T>& k : list) {
          for (int c = 0; c < channels; ++c) blended[c] += k.weight * features[size_t(k.row) * channels + c];
        }
        const T confidence = view.semantic_weight.empty() ? T(1) : T(view.semantic_weight.at(x, y));
        sem = detail::semantic_pixel(blended, maps.alpha[u], teacher, set, weights, confidence / T(valid));
        soft += static_cast<double>(sem.terms.soft) / valid;
        hard += static_cast<double>(sem.terms.hard) / valid;
        surrogate += static_cast<double>(sem.surrogate);
      }

      // q_k = v_k . g for the three kinds of values, then their totals (see AlphaSweep).
      const auto q_color = [&](uint32_t row) { return dot(s.colors[row], gcolor); };
      const auto q_geometry = [&](uint32_t row) {
        return dot(s.projections[row].normal, gnormal) + s.projections[row].distance * gdistance + galpha;
      };
      const auto q_semantic = [&](uint32_t row) {
        if (!semantic) return T(0);
        T q = -sem.offset;
        for (int c = 0; c < channels; ++c) q += sem.coupling[c] * features[size_t(row) * channels + c];
        return q;
      };
      AlphaSweep<T> color, geometry, semantics;
      for (const Contribution<T>& k : list) {
        color.total += k.weight * q_color(k.row);
        geometry.total += k.weight * q_geometry(k.row);
        semantics.total += k.weight * q_semantic(k.row);
      }
      for (int c = 0; c < 3; ++c) color.total += left * T(raster.background[c]) * gcolor[c];

      double residual = 0;
      if (!view.data.color.empty() && (view.data.mask.empty() || view.data.mask.at(x, y) > 0.5f)) {
        for (int c = 0; c < 3; ++c) {
          residual += std::abs(static_cast<double>(maps.color[c * pixels + u]) - view.data.color.at(x, y, c)) / 3;
        }
      }
      const T prior = view.data.prior_depth.empty()
                          ? T(0)
                          : T(view.data.prior_depth.at(x, y)) * T(set.prior_depth_scale);

      for (const Contribution<T>& k : list) {
        const Projection<T>& p = s.projections[k.row];
        const T alpha = k.sample.alpha;
        const T dcolor_alpha = color.next(alpha, k.transmittance, k.weight, q_color(k.row));
        const T dgeometry_alpha = geometry.next(alpha, k.transmittance, k.weight, q_geometry(k.row));
        const T dsemantic_alpha = semantics.next(alpha, k.transmittance, k.weight, q_semantic(k.row));
        const Vec2<T> dmean = alpha_backward(k.sample, p.conic, p.opacity, dcolor_alpha, by_color[k.row]);
        alpha_backward(k.sample, p.conic, p.opacity, dgeometry_alpha, by_geometry[k.row]);
        alpha_backward(k.sample, p.conic, p.opacity, dsemantic_alpha, by_semantics[k.row]);
        dcolor[k.row] += k.weight * gcolor;
        by_geometry[k.row].normal += k.weight * gnormal;
        by_geometry[k.row].distance += k.weight * gdistance;
        if (semantic) {
          for (int c = 0; c < channels; ++c) {
            dfeatures[size_t(k.row) * channels + c] += k.weight * sem.row_gradient[c];
          }
        }
        touched[k.row] = 1;
        out.photometric_mean_abs[k.row].x += std::abs(dmean.x);
        out.photometric_mean_abs[k.row].y += std::abs(dmean.y);
        weight_sum[k.row] += static_cast<double>(k.weight);
        residual_sum[k.row] += static_cast<double>(k.weight) * residual;
        if (prior_unsupported(prior, intersection_depth(p, ray))) {
          unsupported_sum[k.row] += static_cast<double>(k.weight);
        }
      }
    }
  }

  // From projections to parameters.
  out.photometric_mean.assign(rows, Vec2<T>());
  out.coupling_mean.assign(rows, Vec2<T>());
  double photometric_square = 0, coupling_square = 0;
  const double to_ndc_x = 0.5 * maps.width, to_ndc_y = 0.5 * maps.height;
  for (const uint32_t i : s.order) {
    if (!touched[i]) continue;
    ++out.visible;
    const GaussianShape<T>& g = s.shapes[i];
    const Projection<T>& p = s.projections[i];
    detail::add_shape(project_backward(g, s.camera, p, by_color[i]), T(1), i, out.gradient);
    detail::add_shape(project_backward(g, s.camera, p, by_geometry[i]), T(1), i, out.gradient);
    const ShapeGradient<T> coupled = project_backward(g, s.camera, p, by_semantics[i]);
    detail::add_shape(coupled, T(1), i, out.coupling);
    detail::add_shape(coupled, T(out.coupling_scale), i, out.gradient);
    const Vec3<T> dposition =
        sh_color_backward(request.sh_degree, g.position, s.camera.centre, &model.sh[3 * kShCoefficients * i],
                          s.colors[i], dcolor[i], &out.gradient.sh[3 * kShCoefficients * i]);
    for (int k = 0; k < 3; ++k) out.gradient.positions[3 * i + k] += dposition[k];

    const Vec2<T> mean = by_color[i].mean, absolute = out.photometric_mean_abs[i], coupling = by_semantics[i].mean;
    out.photometric_mean[i] = mean;
    out.coupling_mean[i] = coupling;
    photometric_square += static_cast<double>(mean.x * mean.x + mean.y * mean.y);
    coupling_square += static_cast<double>(coupling.x * coupling.x + coupling.y * coupling.y);
    out.statistics.gradient[i] = static_cast<float>(std::hypot(mean.x * to_ndc_x, mean.y * to_ndc_y));
    out.statistics.gradient_abs[i] = static_cast<float>(std::hypot(absolute.x * to_ndc_x, absolute.y * to_ndc_y));
    out.statistics.visible[i] = 1;
    out.statistics.radius[i] = static_cast<float>(p.radius);
    out.statistics.weight[i] = static_cast<float>(weight_sum[i]);
    out.statistics.residual[i] = static_cast<float>(residual_sum[i]);
    out.statistics.unsupported[i] = static_cast<float>(unsupported_sum[i]);
  }
  out.photometric_rms = detail::rms_over(out.visible, photometric_square);
  out.coupling_rms = detail::rms_over(out.visible, coupling_square);

  // Semantic rows.
  for (size_t i = 0; valid > 0 && i < rows; ++i) {
    const T* g = &dfeatures[i * channels];
    T* row = &out.gradient.semantics[i * channels];
    if (!touched[i]) continue;
    if (probabilities) {
      softmax_backward(&features[i * channels], g, channels, row);
    } else {
      std::copy(g, g + channels, row);
    }
  }
  out.losses.semantic_soft += soft;
  out.losses.semantic_hard += hard;
  out.losses.total += set.semantic_soft_weight * soft + set.semantic_hard_weight * hard;
  out.coupling_value = surrogate;

  if (out.visible > 0 || set.opacity_l1_weight != 0 || set.scale_l1_weight != 0) {
    detail::shape_terms(s, touched, out.visible, request, out.losses, out.gradient);
  }
  return out;
}

/// The same with the map losses of engine/losses.
template <class T>
Gradients<T> gradients(const GaussianModelT<T>& model, const TrainingView& view, const StepRequest& request,
                       double bounded_scale) {
  const MapLossFunction<T> losses = [&](const RenderMaps<T>& maps, LossTerms& terms, MapGradients<T>& dmap) {
    map_losses(MapLossInputs<T>{maps, view, request.losses}, terms, dmap);
  };
  return gradients(model, view, request, bounded_scale, losses);
}

}  // namespace aligngs::reference
