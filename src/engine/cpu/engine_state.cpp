// Loading, storing and restructuring the state of the engine.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/huge_pages.h"
#include "engine/cpu/cpu_engine.h"
#include "engine/cpu/tile_products.h"
#include "engine/engine_arrays.h"
#include "engine/formulas/shape_terms.h"
#include "gaussians/restructure.h"

namespace aligngs::cpu {

std::string CpuEngine::device_name() const {
  return "cpu, " + std::to_string(pool_->size()) + (pool_->size() == 1 ? " thread" : " threads");
}

void CpuEngine::load(const GaussianModel& model) {
  check_model(model);
  adopt(model, nullptr);
  balance_ = {};
  reset_density_statistics();
}

void CpuEngine::adopt(const GaussianModel& model, const AdamMoments* moments) {
  map_ = active_.has_remainder() && active_.classes == model.semantic_channels ? active_ : ActiveClasses();
  const auto take_in = [&](const GaussianModel& from, RowKind kind, GaussianModel& to) {
    to = from;
    if (!map_.has_remainder()) return;
    to.semantics = compress_rows(map_, kind, from.semantics);
    to.semantic_channels = map_.channels();
  };
  take_in(model, RowKind::kLogits, model_);
  rounded_for_.reset();
  counts_ = make_class_counts(model_.semantic_channels, map_.remainder());
  if (moments == nullptr) {
    moments_ = {};
  } else {
    take_in(moments->m, RowKind::kMoments, moments_.m);
    take_in(moments->v, RowKind::kMoments, moments_.v);
    moments_.semantic_updates = moments->semantic_updates;
    moments_.sh_used = moments->sh_used;
  }
  settle_memory();
}

void CpuEngine::settle_memory() {
  for (GaussianModel* m : {&model_, &moments_.m, &moments_.v}) {
    for (const NamedArray& a : arrays_of(*m)) ask_for_huge_pages(*a.values);
  }
}

GaussianModel CpuEngine::expanded(const GaussianModel& rows) const {
  GaussianModel out = rows;
  if (!map_.has_remainder()) return out;
  out.semantics = expand_rows(map_, rows.semantics);
  out.semantic_channels = map_.classes;
  return out;
}

AdamMoments& CpuEngine::moments_for_step() {
  if (!has_moments()) {
    moments_.reset(model_);
    settle_memory();
  }
  return moments_;
}

AdamMoments CpuEngine::expanded_moments() const {
  if (!has_moments()) {
    AdamMoments zeros;
    zeros.reset(expanded(model_));
    return zeros;
  }
  return {expanded(moments_.m), expanded(moments_.v), moments_.semantic_updates, moments_.sh_used};
}

void CpuEngine::store(GaussianModel& model) const { model = expanded(model_); }

void CpuEngine::store_shapes(GaussianModel& model) const {
  model = {};
  model.sh_degree = model_.sh_degree;
  model.positions = model_.positions;
  model.log_scales = model_.log_scales;
  model.rotations = model_.rotations;
  model.opacity_logits = model_.opacity_logits;
}

void CpuEngine::reset_density_statistics() {
  for (const NamedArray& a : arrays_of(statistics_)) a.values->assign(model_.size(), 0.0f);
}

void CpuEngine::save_state(EngineState& state) const {
  EngineMemory memory;
  memory.moments = expanded_moments();
  memory.statistics = statistics_;
  memory.balance = balance_;
  pack_state(expanded(model_), std::move(memory), state);
}

void CpuEngine::load_state(const EngineState& state) {
  EngineMemory memory = unpack_state(state);  // everything is read before anything is replaced
  adopt(state.model, &memory.moments);
  statistics_ = std::move(memory.statistics);
  balance_ = memory.balance;
}

void CpuEngine::prepare(EngineInputs inputs) {
  active_top_ = inputs.active_top;
  set_training_views(std::move(inputs.views));
  if (inputs.model) load(*inputs.model);
}

void CpuEngine::set_training_views(std::vector<TrainingView> views) {
  views_ = std::move(views);
  semantic_views_.assign(views_.size(), SemanticView());
  active_ = find_active_classes(views_, active_top_, *pool_);
  for (TrainingView& view : views_) compress_target(active_, *pool_, view.data.semantics);
  if (!active_.has_remainder() && !map_.has_remainder()) return;
  const GaussianModel model = expanded(model_);
  if (!has_moments()) return adopt(model, nullptr);
  const AdamMoments moments = expanded_moments();
  adopt(model, &moments);
}

void CpuEngine::restructure(const RestructurePlan& plan) {
  check_plan(plan, model_.size());
  restructure_model(plan, model_);
  rounded_for_.reset();
  if (has_moments()) {
    for (GaussianModel* m : {&moments_.m, &moments_.v}) {
      for (const NamedArray& a : arrays_of(*m)) restructure_rows(plan, a.width, *a.values);
    }
    restructure_rows(plan, 1, moments_.semantic_updates);
  }
  for (const NamedArray& a : arrays_of(statistics_)) restructure_rows(plan, a.width, *a.values);
  settle_memory();
}

void CpuEngine::reset_opacity(float maximum) {
  const float logit = reset_logit(maximum);
  for (float& x : model_.opacity_logits) x = std::min(x, logit);
  std::fill(moments_.m.opacity_logits.begin(), moments_.m.opacity_logits.end(), 0.0f);
  std::fill(moments_.v.opacity_logits.begin(), moments_.v.opacity_logits.end(), 0.0f);
}

void CpuEngine::add_position_noise(const PositionNoise& noise) {
  if (noise.rate == 0) return;
  constexpr size_t kRowsPerTask = 4096;
  pool_->parallel_for(model_.size(), kRowsPerTask, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const float opacity = 1 / (1 + std::exp(-model_.opacity_logits[i]));
      const Vec3<float> shift = position_noise(noise, i, opacity, &model_.log_scales[3 * i], &model_.rotations[4 * i]);
      for (int k = 0; k < 3; ++k) model_.positions[3 * i + static_cast<size_t>(k)] += shift[k];
    }
  });
}

void CpuEngine::raise_scales(const std::vector<float>& log_floors) {
  check_floors(log_floors, model_.size());
  for (size_t i = 0; i < model_.size(); ++i) {
    float* s = &model_.log_scales[3 * i];
    Vec3<float> scale{s[0], s[1], s[2]};
    raise_larger_scales(log_floors[i], scale);
    for (int k = 0; k < 3; ++k) s[k] = scale[k];
  }
}

}  // namespace aligngs::cpu
