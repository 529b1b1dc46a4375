#include "engine/cpu/reduce.h"

#include <cmath>

#include "engine/cpu/adam.h"
#include "engine/formulas/color.h"
#include "engine/formulas/shape_terms.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kGrain = 512;  ///< rows per task; also the unit in which sums are formed, so never depends on threads
constexpr float kTwoLn2 = 1.38629436f;  ///< the conic is 2 ln 2 F F^T (splats.h)

struct Moments {
  float p, r, one, pp, pr, rr;
};

Vec2<float> mean_gradient(const Splat& s, float p, float r) {
  return {kTwoLn2 * s.fxx * p, kTwoLn2 * (s.fxy * p + s.fyy * r)};
}

float length(float x, float y) { return std::sqrt(x * x + y * y); }

/// dL / d (mean, conic, opacity) from whitened moments: dy = r / fyy, dx = (p - fxy dy) / fxx.
void add_moments(const Splat& s, const Moments& m, float scale, ProjectionGradient<float>& out) {
  const Vec2<float> mean = mean_gradient(s, m.p, m.r);
  const float a = 1.0f / s.fxx, c = 1.0f / s.fyy, b = -s.fxy * a * c;  // dx = a p + b r, dy = c r
  const float xx = a * a * m.pp + 2 * a * b * m.pr + b * b * m.rr;
  const float xy = c * (a * m.pr + b * m.rr), yy = c * c * m.rr;
  out.mean.x += scale * mean.x;
  out.mean.y += scale * mean.y;
  out.conic.xx += scale * -0.5f * xx;
  out.conic.xy += scale * -xy;
  out.conic.yy += scale * -0.5f * yy;
  out.opacity += scale * m.one / s.opacity;
}

/// The projection as project_backward reads it.
Projection<float> projection_of(const Splat& s, int normal_axis) {
  Projection<float> p;
  p.status = ProjectionStatus::kVisible;
  p.conic = {kTwoLn2 * s.fxx * s.fxx, kTwoLn2 * s.fxx * s.fxy, kTwoLn2 * (s.fxy * s.fxy + s.fyy * s.fyy)};
  p.opacity = s.opacity;
  p.normal = {s.normal[0], s.normal[1], s.normal[2]};
  p.normal_axis = normal_axis;
  return p;
}

GaussianShape<float> shape_of(const GaussianModel& model, size_t i) {
  const float *m = &model.positions[3 * i], *s = &model.log_scales[3 * i], *q = &model.rotations[4 * i];
  return {{m[0], m[1], m[2]}, {s[0], s[1], s[2]}, {q[0], q[1], q[2], q[3]}, model.opacity_logits[i]};
}

/// Sums of one chunk of rows.
struct ShapeSums {
  double flatten = 0, opacity = 0, scale = 0;
};

/// Gradients of one row; adds the row's shape terms to `sums`.
void row_gradients(const ReduceInputs& in, size_t i, ParameterGradients& out, ShapeSums& sums) {
  const LossSettings& set = in.request.losses;
  const GaussianShape<float> shape = shape_of(in.model, i);
  const bool touched = out.touched[i] != 0;
  ShapeGradient<float> g;
  if (touched) {
    const SplatGradient& d = in.slots.slots[static_cast<size_t>(in.lists.slot_begin[i])];
    const Splat& s = in.view.splats[i];
    ProjectionGradient<float> dp;
    add_moments(s, {d.p, d.r, d.one, d.pp, d.pr, d.rr}, 1.0f, dp);
    if (in.coupling_scale != 0) {
      add_moments(s, {d.coupling_p, d.coupling_r, d.coupling_one, d.coupling_pp, d.coupling_pr, d.coupling_rr},
                  in.coupling_scale, dp);
    }
    dp.normal = {d.normal[0], d.normal[1], d.normal[2]};
    dp.distance = d.distance;
    g = project_backward(shape, in.view.camera, projection_of(s, smallest_axis(shape.log_scale)), dp);
    float* dsh = out.sh.data() + 3 * kShCoefficients * i;
    std::fill(dsh, dsh + 3 * kShCoefficients, 0.0f);
    g.position += sh_color_backward(in.request.sh_degree, shape.position, in.view.camera.centre,
                                    &in.model.sh[3 * kShCoefficients * i],
                                    Vec3<float>{s.color[0], s.color[1], s.color[2]},
                                    Vec3<float>{d.color[0], d.color[1], d.color[2]}, dsh);
  }
  const float extent = in.request.extent, rows = static_cast<float>(in.model.size());
  if (set.flatten_weight != 0 && touched) {
    const float value = flatten_value(shape.log_scale, extent);
    sums.flatten += value;
    g.log_scale[smallest_axis(shape.log_scale)] += set.flatten_weight * value / static_cast<float>(in.totals.visible);
  }
  if (set.opacity_l1_weight != 0) {
    float derivative;
    sums.opacity += opacity_of_logit(shape.opacity_logit, derivative);
    g.opacity_logit += set.opacity_l1_weight * derivative / rows;
  }
  if (set.scale_l1_weight != 0) {
    for (int k = 0; k < 3; ++k) {
      const float value = scale_value(shape.log_scale[k], extent);
      sums.scale += value;
      g.log_scale[k] += set.scale_l1_weight * value / (3 * rows);
    }
  }
  for (int k = 0; k < 3; ++k) {
    out.positions[3 * i + k] = g.position[k];
    out.log_scales[3 * i + k] = g.log_scale[k];
  }
  for (int k = 0; k < 4; ++k) out.rotations[4 * i + k] = g.rotation[k];
  out.opacity_logits[i] = g.opacity_logit;
}

/// Name of the first class in which row i is beyond the limit.
const char* bad_term(const ParameterGradients& g, size_t i) {
  if (!all_within(g.positions.data() + 3 * i, 3, kGradientLimit)) return "positions";
  if (!all_within(g.log_scales.data() + 3 * i, 3, kGradientLimit)) return "log_scales";
  if (!all_within(g.rotations.data() + 4 * i, 4, kGradientLimit)) return "rotations";
  if (!all_within(g.opacity_logits.data() + i, 1, kGradientLimit)) return "opacity_logits";
  if (g.touched[i] != 0 && !all_within(g.sh.data() + 3 * kShCoefficients * i, 3 * kShCoefficients, kGradientLimit)) {
    return "sh";
  }
  return nullptr;
}

}  // namespace

SlotTotals sum_slots(const ProjectedView& view, const TileLists& lists, ThreadPool& pool, SlotGradients& slots,
                     ParameterGradients& gradients) {
  const size_t n = view.size();
  gradients.touched.resize(n);
  struct ChunkTotals {
    size_t visible = 0;
    double photometric = 0, coupling = 0;
  };
  std::vector<ChunkTotals> chunks((n + kGrain - 1) / kGrain);
  pool.parallel_for(n, kGrain, [&](size_t begin, size_t end, int) {
    ChunkTotals& total = chunks[begin / kGrain];
    for (size_t i = begin; i < end; ++i) {
      SplatGradient sum{};
      float* to = reinterpret_cast<float*>(&sum);
      bool touched = false;
      for (uint64_t slot = lists.slot_begin[i]; slot < lists.slot_begin[i + 1]; ++slot) {
        if (slots.used[static_cast<size_t>(slot)] == 0) continue;
        const float* from = reinterpret_cast<const float*>(&slots.slots[static_cast<size_t>(slot)]);
        for (size_t k = 0; k < kSplatGradientFloats; ++k) to[k] += from[k];
        touched = true;
      }
      gradients.touched[i] = touched ? 1 : 0;
      if (!touched) continue;
      slots.slots[static_cast<size_t>(lists.slot_begin[i])] = sum;
      ++total.visible;
      const Splat& s = view.splats[i];
      const Vec2<float> photometric = mean_gradient(s, sum.photometric_p, sum.photometric_r);
      const Vec2<float> coupling = mean_gradient(s, sum.coupling_p, sum.coupling_r);
      total.photometric += static_cast<double>(photometric.x * photometric.x + photometric.y * photometric.y);
      total.coupling += static_cast<double>(coupling.x * coupling.x + coupling.y * coupling.y);
    }
  });
  SlotTotals totals;
  double photometric = 0, coupling = 0;
  for (const ChunkTotals& c : chunks) {
    totals.visible += c.visible;
    photometric += c.photometric;
    coupling += c.coupling;
  }
  if (totals.visible > 0) {
    totals.photometric_rms = std::sqrt(photometric / static_cast<double>(totals.visible));
    totals.coupling_rms = std::sqrt(coupling / static_cast<double>(totals.visible));
  }
  return totals;
}

BadGradient parameter_gradients(const ReduceInputs& in, ThreadPool& pool, LossTerms& terms,
                                ParameterGradients& gradients) {
  const size_t n = in.model.size();
  gradients.positions.resize(3 * n);
  gradients.log_scales.resize(3 * n);
  gradients.rotations.resize(4 * n);
  gradients.opacity_logits.resize(n);
  gradients.sh.resize(3 * kShCoefficients * n);
  const size_t chunk_count = (n + kGrain - 1) / kGrain;
  std::vector<ShapeSums> sums(chunk_count);
  std::vector<BadGradient> bad(chunk_count);
  pool.parallel_for(n, kGrain, [&](size_t begin, size_t end, int) {
    const size_t chunk = begin / kGrain;
    for (size_t i = begin; i < end; ++i) {
      row_gradients(in, i, gradients, sums[chunk]);
      if (bad[chunk].row >= 0) continue;
      if (const char* term = bad_term(gradients, i)) bad[chunk] = {static_cast<int64_t>(i), term};
    }
  });
  ShapeSums total;
  for (const ShapeSums& s : sums) {
    total.flatten += s.flatten;
    total.opacity += s.opacity;
    total.scale += s.scale;
  }
  const LossSettings& set = in.request.losses;
  if (in.totals.visible > 0) total.flatten /= static_cast<double>(in.totals.visible);
  if (n > 0) total.opacity /= static_cast<double>(n);
  if (n > 0) total.scale /= static_cast<double>(3 * n);
  terms.flatten += total.flatten;
  terms.opacity_l1 += total.opacity;
  terms.scale_l1 += total.scale;
  terms.total += set.flatten_weight * total.flatten + set.opacity_l1_weight * total.opacity +
                 set.scale_l1_weight * total.scale;
  for (const BadGradient& b : bad) {
    if (b.row >= 0) return b;
  }
  return {};
}

void add_density_statistics(const ReduceInputs& in, const std::vector<uint8_t>& touched, ThreadPool& pool,
                            DensityStatistics& statistics) {
  const float to_ndc_x = 0.5f * in.view.width, to_ndc_y = 0.5f * in.view.height;
  pool.parallel_for(in.model.size(), kGrain, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      if (touched[i] == 0) continue;
      const SplatGradient& d = in.slots.slots[static_cast<size_t>(in.lists.slot_begin[i])];
      const Splat& s = in.view.splats[i];
      const Vec2<float> mean = mean_gradient(s, d.photometric_p, d.photometric_r);
      const Vec2<float> absolute{kTwoLn2 * s.fxx * d.photometric_abs_p, kTwoLn2 * d.photometric_abs_y};
      statistics.gradient[i] += length(mean.x * to_ndc_x, mean.y * to_ndc_y);
      statistics.gradient_abs[i] += length(absolute.x * to_ndc_x, absolute.y * to_ndc_y);
      statistics.visible[i] += 1.0f;
      statistics.radius[i] = std::max(statistics.radius[i], in.view.radius[i]);
      statistics.weight[i] += d.weight;
      statistics.residual[i] += d.residual;
      statistics.unsupported[i] += d.unsupported;
    }
  });
}

}  // namespace aligngs::cpu
