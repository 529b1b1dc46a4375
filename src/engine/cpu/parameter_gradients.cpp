#include "engine/cpu/parameter_gradients.h"

#include <cmath>
#include <cstring>
#include <numeric>

#include "core/target_clones.h"
#include "core/vector_lanes.h"
#include "engine/cpu/activations.h"
#include "engine/cpu/adam.h"
#include "engine/cpu/project_backward.h"
#include "engine/formulas/shape_terms.h"

namespace aligngs::cpu {
namespace {

/// rows per task; also the unit in which sums are formed, so never depends on threads
constexpr size_t kGradientRowsPerTask = 512;
constexpr float kTwoLn2 = 1.38629436f;  ///< the conic is 2 ln 2 F F^T (splats.h)

Vec2<float> mean_gradient(const Splat& s, float p, float r) {
  return {kTwoLn2 * s.fxx * p, kTwoLn2 * (s.fxy * p + s.fyy * r)};
}

float length(float x, float y) { return std::sqrt(x * x + y * y); }

/// Sums of one chunk of rows: values of the shape terms, and squares of gradients of the mean.
struct ChunkSums {
  double flatten = 0, opacity = 0, scale = 0;
  double photometric = 0, coupling = 0;
};

/// Inputs of the shape terms from a chunk of rows, beginning with row `first`; empty where no term asks for it.
struct ShapeValues {
  size_t first = 0;
  AlignedArray<float> scales;     ///< [rows][3]
  AlignedArray<float> opacities;  ///< [rows]
};

void shape_values(const ParameterGradientInputs& in, size_t begin, size_t end, ShapeValues& out) {
  const LossSettings& set = in.request.losses;
  const size_t n = end - begin;
  out.first = begin;
  if (set.weight[Loss::kFlatten] != 0 || set.weight[Loss::kScaleL1] != 0) {
    out.scales.resize(3 * n);
    exp_range(&in.model.log_scales[3 * begin], 3 * n, out.scales.data());
  }
  if (set.weight[Loss::kOpacityL1] != 0) {
    out.opacities.resize(n);
    sigmoid_range(&in.model.opacity_logits[begin], n, out.opacities.data());
  }
}

/// Adds the shape terms of row i (formulas/shape_terms.h) to its gradient and their values to `sums`.
void add_shape_terms(const ParameterGradientInputs& in, const ShapeValues& values, size_t i, bool touched,
                     RowGradient& g, ChunkSums& sums) {
  const LossSettings& set = in.request.losses;
  const float inverse_extent = 1.0f / in.request.extent, rows = static_cast<float>(in.model.size());
  const float* s = values.scales.empty() ? nullptr : values.scales.data() + 3 * (i - values.first);
  if (set.weight[Loss::kFlatten] != 0 && touched) {
    const float* log_scale = &in.model.log_scales[3 * i];
    const int axis = smallest_axis(Vec3<float>{log_scale[0], log_scale[1], log_scale[2]});
    const float value = s[axis] * inverse_extent;
    sums.flatten += static_cast<double>(value);
    g.log_scale[axis] += set.weight[Loss::kFlatten] * value / static_cast<float>(in.visible);
  }
  if (set.weight[Loss::kOpacityL1] != 0) {
    const float o = values.opacities[i - values.first];
    sums.opacity += static_cast<double>(o);
    g.opacity_logit += set.weight[Loss::kOpacityL1] * o * (1.0f - o) / rows;
  }
  if (set.weight[Loss::kScaleL1] != 0) {
    for (int k = 0; k < 3; ++k) {
      const float value = s[k] * inverse_extent;
      if (!is_finite(value)) continue;  // a row so large that projection culls it
      sums.scale += static_cast<double>(value);
      g.log_scale[k] += set.weight[Loss::kScaleL1] * value / (3 * rows);
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

/// Sums of the slots [begin, end) that are seen.
ALIGNGS_TARGET_CLONES
void sum_slots(const CoupledSplatGradient* slots, const uint8_t* seen, size_t begin, size_t end,
               CoupledSplatGradient& sum) {
  static_assert(sizeof(CoupledSplatGradient) == 4 * sizeof(FloatLanes));
  FloatLanes a{}, b{}, c{}, d{};  // in registers
  for (size_t slot = begin; slot < end; ++slot) {
    if (seen[slot] == 0) continue;
    FloatLanes from[4];
    std::memcpy(from, &slots[slot], sizeof(from));
    a += from[0];
    b += from[1];
    c += from[2];
    d += from[3];
  }
  const FloatLanes all[4] = {a, b, c, d};
  std::memcpy(static_cast<void*>(&sum), all, sizeof(all));
}

void add_squares(const Splat& s, const CoupledSplatGradient& sum, ChunkSums& out) {
  const Vec2<float> photometric = mean_gradient(s, sum.maps.photometric_p, sum.maps.photometric_r);
  const Vec2<float> coupling = mean_gradient(s, sum.coupling_p, sum.coupling_r);
  out.photometric += static_cast<double>(photometric.x * photometric.x + photometric.y * photometric.y);
  out.coupling += static_cast<double>(coupling.x * coupling.x + coupling.y * coupling.y);
}

DensitySums density_sums(const SplatGradient& s) {
  return {s.photometric_p, s.photometric_r, s.photometric_abs_p, s.photometric_abs_y,
          s.weight,        s.residual,      s.unsupported};
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

size_t mark_touched(const TileLists& lists, const BlendRecord& record, ThreadPool& pool,
                    std::vector<uint8_t>& touched) {
  const size_t n = lists.rank.size();
  touched.resize(n);
  std::vector<size_t> chunks((n + kGradientRowsPerTask - 1) / kGradientRowsPerTask, 0);
  pool.parallel_for(n, kGradientRowsPerTask, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      uint8_t any = 0;
      for (uint64_t slot = lists.slot_begin[i]; slot < lists.slot_begin[i + 1]; ++slot) {
        any |= record.seen[static_cast<size_t>(slot)];
      }
      touched[i] = any;
      chunks[begin / kGradientRowsPerTask] += any;
    }
  });
  return std::accumulate(chunks.begin(), chunks.end(), size_t(0));
}

BadGradient parameter_gradients(const ParameterGradientInputs& in, ThreadPool& pool, LossTerms& terms,
                                ParameterGradientTotals& totals, ParameterGradients& gradients) {
  const size_t n = in.model.size();
  gradients.positions.resize(3 * n);
  gradients.log_scales.resize(3 * n);
  gradients.rotations.resize(4 * n);
  gradients.opacity_logits.resize(n);
  gradients.sh.resize(3 * kShCoefficients * n);
  if (in.request.collect_density) gradients.density.resize(n);
  const size_t chunk_count = (n + kGradientRowsPerTask - 1) / kGradientRowsPerTask;
  std::vector<ChunkSums> sums(chunk_count);
  std::vector<BadGradient> bad(chunk_count);
  const ProjectBackwardInputs backward{in.model, in.view, in.request.sh_degree, in.coupling_scale,
                                       in.request.raster.dropout.factor()};
  pool.parallel_for(n, kGradientRowsPerTask, [&](size_t begin, size_t end, int) {
    const size_t chunk = begin / kGradientRowsPerTask;
    uint32_t rows[kMaxBackwardRows];
    CoupledSplatGradient row_sums[kMaxBackwardRows];
    RowGradient row[kMaxBackwardRows];
    size_t count = 0;
    thread_local ShapeValues values;
    shape_values(in, begin, end, values);
    for (size_t i = begin; i < end; ++i) {
      if (gradients.touched[i] == 0) {
        RowGradient zero{};
        add_shape_terms(in, values, i, false, zero, sums[chunk]);
        store_row(zero, i, gradients);
      } else {
        rows[count] = static_cast<uint32_t>(i);
        sum_slots(in.slots.data(), in.record.seen.data(), static_cast<size_t>(in.lists.slot_begin[i]),
                  static_cast<size_t>(in.lists.slot_begin[i + 1]), row_sums[count]);
        add_squares(in.view.splats[i], row_sums[count], sums[chunk]);
        if (in.request.collect_density) gradients.density[i] = density_sums(row_sums[count].maps);
        ++count;
      }
      if (count < kMaxBackwardRows && (i + 1 < end || count == 0)) continue;
      project_backward_rows(backward, rows, row_sums, count, row, gradients.sh.data());
      for (size_t k = 0; k < count; ++k) {
        add_shape_terms(in, values, rows[k], true, row[k], sums[chunk]);
        store_row(row[k], rows[k], gradients);
      }
      count = 0;
    }
    bad[chunk] = first_bad_row(gradients, begin, end);
  });
  ChunkSums total;
  for (const ChunkSums& s : sums) {
    total.photometric += s.photometric;
    total.coupling += s.coupling;
    total.flatten += s.flatten;
    total.opacity += s.opacity;
    total.scale += s.scale;
  }
  const LossSettings& set = in.request.losses;
  if (in.visible > 0) {
    totals.photometric_rms = std::sqrt(total.photometric / static_cast<double>(in.visible));
    totals.coupling_rms = std::sqrt(total.coupling / static_cast<double>(in.visible));
    total.flatten /= static_cast<double>(in.visible);
  }
  if (n > 0) total.opacity /= static_cast<double>(n);
  if (n > 0) total.scale /= static_cast<double>(3 * n);
  terms.add(Loss::kFlatten, set.weight[Loss::kFlatten], total.flatten);
  terms.add(Loss::kOpacityL1, set.weight[Loss::kOpacityL1], total.opacity);
  terms.add(Loss::kScaleL1, set.weight[Loss::kScaleL1], total.scale);
  for (const BadGradient& b : bad) {
    if (b.row >= 0) return b;
  }
  return {};
}

void add_density_statistics(const ParameterGradientInputs& in, const ParameterGradients& gradients, ThreadPool& pool,
                            DensityStatistics& statistics) {
  const float to_ndc_x = 0.5f * in.view.width, to_ndc_y = 0.5f * in.view.height;
  pool.parallel_for(in.model.size(), kGradientRowsPerTask, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      if (gradients.touched[i] == 0) continue;
      const DensitySums& d = gradients.density[i];
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
