#include "engine/cpu/optimiser.h"

#include <cmath>

#include "core/error.h"
#include "engine/cpu/adam.h"
#include "engine/cpu/bf16_packing.h"
#include "engine/cpu/semantic_rows.h"
#include "engine/cpu/tile_products.h"
#include "engine/formulas/shape_terms.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kNumbersPerTask = 16384;  ///< a multiple of every vector length
constexpr size_t kUpdatedRowsPerTask = 512;
constexpr size_t kUpdatedRowsAhead = 2;  ///< semantic rows, of which an update reads four

void flat_adam(const AdamStep<float>& step, const AlignedArray<float>& gradients, ThreadPool& pool,
               std::vector<float>& parameters, std::vector<float>& m, std::vector<float>& v) {
  pool.parallel_for(parameters.size(), kNumbersPerTask, [&](size_t begin, size_t end, int) {
    adam_range(step, gradients.data() + begin, end - begin, parameters.data() + begin, m.data() + begin,
               v.data() + begin);
  });
}

void semantic_adam(const StepRequest& request, const SemanticGradients& semantics, const ProjectedView& view,
                   ThreadPool& pool, GaussianModel& model, AdamMoments& moments) {
  const size_t channels = static_cast<size_t>(model.semantic_channels),
               padded = padded_channels(model.semantic_channels), depth = padded_depth(padded);
  std::vector<float>& m = moments.m.semantics;
  std::vector<float>& v = moments.v.semantics;
  const AdamRowSteps steps = make_adam_row_steps(request.adam, request.rates.semantic, request.step);
  const auto gradient_of = [&](size_t i) -> const float* {
    if (semantics.gradients == nullptr || view.rects[i].area() == 0) return nullptr;
    const size_t rank = semantics.rank[i];
    return semantics.written[rank] != 0 ? semantics.gradients + rank * padded : nullptr;
  };
  pool.parallel_for(model.size(), kUpdatedRowsPerTask, [&](size_t begin, size_t end, int) {
    thread_local AlignedArray<float> scratch;
    scratch.resize(padded);
    const auto prefetch = [&](size_t i) {
      const float* g = i < end ? gradient_of(i) : nullptr;
      if (g == nullptr) return;
      prefetch_row(g, channels);
      for (const std::vector<float>* x : {&model.semantics, &m, &v}) prefetch_row(x->data() + i * channels, channels);
      if (semantics.rounded != nullptr) {
        prefetch_row(reinterpret_cast<const float*>(semantics.rounded + i * depth), depth / 2);
      }
    };
    for (size_t i = begin; i < end; ++i) {
      prefetch(i + kUpdatedRowsAhead);
      const float* g = gradient_of(i);
      if (g == nullptr && request.adam.skip_invisible_semantics) continue;
      const AdamStep<float> step = steps.at(++moments.semantic_updates[i]);
      float* row = model.semantics.data() + i * channels;
      uint16_t* rounded = semantics.rounded != nullptr ? semantics.rounded + i * depth : nullptr;
      if (rounded != nullptr && semantics.probabilities && g != nullptr) {
        adam_semantic_row(step, g, rounded, channels, row, m.data() + i * channels, v.data() + i * channels);
      } else {
        const float* pi = nullptr;
        if (g != nullptr && semantics.softmax != nullptr) {
          pi = semantics.softmax + semantics.rank[i] * padded;
        } else if (g != nullptr && semantics.probabilities) {
          softmax_row(row, channels, padded, semantics.last_shift, scratch.data());
          pi = scratch.data();
        }
        adam_semantic_row(step, g, pi, channels, row, m.data() + i * channels, v.data() + i * channels);
      }
      if (rounded == nullptr) continue;
      round_features(row, channels, padded, depth, semantics.probabilities, semantics.last_shift, scratch.data(),
                     rounded);
    }
  });
}

}  // namespace

void optimise(const StepRequest& request, const ParameterGradients& gradients, const SemanticGradients& semantics,
              const ProjectedView& view, ThreadPool& pool, GaussianModel& model, AdamMoments& moments) {
  const LearningRates& rates = request.rates;
  const auto step_of = [&](float rate) { return make_adam_step<float>(request.adam, rate, request.step); };
  GaussianModel &m = moments.m, &v = moments.v;
  flat_adam(step_of(rates.position), gradients.positions, pool, model.positions, m.positions, v.positions);
  flat_adam(step_of(rates.scale), gradients.log_scales, pool, model.log_scales, m.log_scales, v.log_scales);
  flat_adam(step_of(rates.rotation), gradients.rotations, pool, model.rotations, m.rotations, v.rotations);
  flat_adam(step_of(rates.opacity), gradients.opacity_logits, pool, model.opacity_logits, m.opacity_logits,
            v.opacity_logits);

  constexpr size_t kShRow = 3 * kShCoefficients;
  moments.sh_used = std::max(moments.sh_used, size_t(3) * sh_coefficient_count(request.sh_degree));
  const ShAdam sh{step_of(rates.sh_dc), step_of(rates.sh_rest), moments.sh_used};
  pool.parallel_for(model.size(), kUpdatedRowsPerTask, [&](size_t begin, size_t end, int) {
    adam_sh_rows(sh, gradients.sh.data() + kShRow * begin, gradients.touched.data() + begin, end - begin,
                 model.sh.data() + kShRow * begin, m.sh.data() + kShRow * begin, v.sh.data() + kShRow * begin);
  });

  if (model.semantic_channels > 0 && (semantics.gradients != nullptr || !request.adam.skip_invisible_semantics)) {
    semantic_adam(request, semantics, view, pool, model, moments);
  }

  const ShapeLimits& limits = request.limits;
  if (limits.flat_ratio_max > 0 || limits.aspect_max > 0 || limits.scale_max > 0) {
    pool.parallel_for(model.size(), kUpdatedRowsPerTask, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        float* s = &model.log_scales[3 * i];
        Vec3<float> log_scale{s[0], s[1], s[2]};
        apply_shape_limits(limits, log_scale);
        for (int k = 0; k < 3; ++k) s[k] = log_scale[k];
      }
    });
  }
}

}  // namespace aligngs::cpu
