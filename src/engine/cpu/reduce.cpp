#include "engine/cpu/reduce.h"

#include <cmath>

#include "engine/cpu/adam.h"
#include "engine/cpu/project_backward.h"
#include "engine/formulas/shape_terms.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kGrain = 512;  ///< rows per task; also the unit in which sums are formed, so never depends on threads
constexpr float kTwoLn2 = 1.38629436f;  ///< the conic is 2 ln 2 F F^T (splats.h)

Vec2<float> mean_gradient(const Splat& s, float p, float r) {
  return {kTwoLn2 * s.fxx * p, kTwoLn2 * (s.fxy * p + s.fyy * r)};
}

float length(float x, float y) { return std::sqrt(x * x + y * y); }

/// Sums of one chunk of rows.
struct ShapeSums {
  double flatten = 0, opacity = 0, scale = 0;
};

/// Adds the shape terms of row i to its gradient and their values to `sums`.
void add_shape_terms(const ReduceInputs& in, size_t i, bool touched, RowGradient& g, ShapeSums& sums) {
  const LossSettings& set = in.request.losses;
  const float extent = in.request.extent, rows = static_cast<float>(in.model.size());
  const float* s = &in.model.log_scales[3 * i];
  if (set.flatten_weight != 0 && touched) {
    const Vec3<float> log_scale{s[0], s[1], s[2]};
    const float value = flatten_value(log_scale, extent);
    sums.flatten += static_cast<double>(value);
    g.log_scale[smallest_axis(log_scale)] += set.flatten_weight * value / static_cast<float>(in.totals.visible);
  }
  if (set.opacity_l1_weight != 0) {
    float derivative;
    sums.opacity += static_cast<double>(opacity_of_logit(in.model.opacity_logits[i], derivative));
    g.opacity_logit += set.opacity_l1_weight * derivative / rows;
  }
  if (set.scale_l1_weight != 0) {
    for (int k = 0; k < 3; ++k) {
      const float value = scale_value(s[k], extent);
      if (!is_finite(value)) continue;  // a row so large that projection culls it
      sums.scale += static_cast<double>(value);
      g.log_scale[k] += set.scale_l1_weight * value / (3 * rows);
    }
  }
}

void store_row(const RowGradient& g, size_t i, ParameterGradients& out) {
  for (int k = 0; k < 3; ++k) out.positions[3 * i + k] = g.position[k];
  for (int k = 0; k < 3; ++k) out.log_scales[3 * i + k] = g.log_scale[k];
  for (int k = 0; k < 4; ++k) out.rotations[4 * i + k] = g.rotation[k];
  out.opacity_logits[i] = g.opacity_logit;
}

/// Name of the first class in which row i is beyond the limit, or nullptr.
const char* bad_term(const ParameterGradients& g, size_t i) {
  if (!all_within(g.positions.data() + 3 * i, 3, kGradientLimit)) return "positions";
  if (!all_within(g.log_scales.data() + 3 * i, 3, kGradientLimit)) return "log_scales";
  if (!all_within(g.rotations.data() + 4 * i, 4, kGradientLimit)) return "rotations";
  if (!all_within(g.opacity_logits.data() + i, 1, kGradientLimit)) return "opacity_logits";
  constexpr size_t kShRow = 3 * kShCoefficients;
  if (g.touched[i] != 0 && !all_within(g.sh.data() + kShRow * i, kShRow, kGradientLimit)) return "sh";
  return nullptr;
}

/// The first of rows [begin, end) with an unusable gradient. Looks at whole ranges first.
BadGradient first_bad_row(const ParameterGradients& g, size_t begin, size_t end) {
  const size_t n = end - begin;
  constexpr size_t kShRow = 3 * kShCoefficients;
  bool good = all_within(g.positions.data() + 3 * begin, 3 * n, kGradientLimit) &&
              all_within(g.log_scales.data() + 3 * begin, 3 * n, kGradientLimit) &&
              all_within(g.rotations.data() + 4 * begin, 4 * n, kGradientLimit) &&
              all_within(g.opacity_logits.data() + begin, n, kGradientLimit);
  for (size_t i = begin; i < end && good; ++i) {
    good = g.touched[i] == 0 || all_within(g.sh.data() + kShRow * i, kShRow, kGradientLimit);
  }
  for (size_t i = begin; i < end && !good; ++i) {
    if (const char* term = bad_term(g, i)) return {static_cast<int64_t>(i), term};
  }
  return {};
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
  const ProjectBackwardInputs backward{in.model, in.view, in.request.sh_degree, in.coupling_scale};
  pool.parallel_for(n, kGrain, [&](size_t begin, size_t end, int) {
    const size_t chunk = begin / kGrain;
    uint32_t rows[kMaxBackwardRows];
    const SplatGradient* row_sums[kMaxBackwardRows];
    RowGradient row[kMaxBackwardRows];
    size_t count = 0;
    for (size_t i = begin; i < end; ++i) {
      if (gradients.touched[i] == 0) {
        RowGradient zero{};
        add_shape_terms(in, i, false, zero, sums[chunk]);
        store_row(zero, i, gradients);
      } else {
        rows[count] = static_cast<uint32_t>(i);
        row_sums[count++] = &in.slots.slots[static_cast<size_t>(in.lists.slot_begin[i])];
      }
      if (count < kMaxBackwardRows && (i + 1 < end || count == 0)) continue;
      project_backward_rows(backward, rows, row_sums, count, row, gradients.sh.data());
      for (size_t k = 0; k < count; ++k) {
        add_shape_terms(in, rows[k], true, row[k], sums[chunk]);
        store_row(row[k], rows[k], gradients);
      }
      count = 0;
    }
    bad[chunk] = first_bad_row(gradients, begin, end);
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
  terms.total +=
      set.flatten_weight * total.flatten + set.opacity_l1_weight * total.opacity + set.scale_l1_weight * total.scale;
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
