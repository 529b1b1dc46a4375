// Loading, storing and restructuring the state of the engine.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "engine/cpu/cpu_engine.h"
#include "engine/cpu/huge_pages.h"
#include "engine/cpu/tile_products.h"

namespace aligngs::cpu {
namespace {

struct NamedArray {
  const char* name;
  std::vector<float>* values;
  size_t width;  ///< numbers per row
};

std::vector<NamedArray> arrays_of(GaussianModel& model) {
  return {{"positions", &model.positions, 3},
          {"log_scales", &model.log_scales, 3},
          {"rotations", &model.rotations, 4},
          {"opacity_logits", &model.opacity_logits, 1},
          {"sh", &model.sh, size_t(3) * kShCoefficients},
          {"semantics", &model.semantics, static_cast<size_t>(model.semantic_channels)}};
}

std::vector<NamedArray> arrays_of(DensityStatistics& s) {
  return {{"gradient", &s.gradient, 1},      {"gradient_abs", &s.gradient_abs, 1},
          {"visible", &s.visible, 1},        {"radius", &s.radius, 1},
          {"weight", &s.weight, 1},          {"residual", &s.residual, 1},
          {"unsupported", &s.unsupported, 1}};
}

void check_shape(GaussianModel model) {
  for (const NamedArray& a : arrays_of(model)) {
    if (a.values->size() == a.width * model.size()) continue;
    throw Error({ErrorKind::kFailed,
                 std::string(a.name) + " holds " + std::to_string(a.values->size()) + " numbers for " +
                     std::to_string(model.size()) + " Gaussians",
                 {},
                 a.name,
                 "the model was not resized as a whole"});
  }
}

/// A copy of a named array of the state. Throws when it is absent or has another length.
std::vector<float> take(const EngineState& state, const std::string& name, size_t length) {
  const auto found = state.arrays.find(name);
  if (found == state.arrays.end()) {
    throw_bad_input({}, name, "the checkpoint lacks this array", "resume from an older checkpoint");
  }
  if (found->second.size() != length) {
    throw_bad_input({}, name,
                    "the checkpoint's array has " + std::to_string(found->second.size()) + " numbers instead of " +
                        std::to_string(length),
                    "resume from an older checkpoint");
  }
  return found->second;
}

}  // namespace

std::string CpuEngine::device_name() const {
  return "cpu, " + std::to_string(pool_->size()) + (pool_->size() == 1 ? " thread" : " threads");
}

void CpuEngine::load(const GaussianModel& model) {
  check_shape(model);
  if (model.size() > 0xffffffffull) throw_resources({}, "more than 2^32 Gaussians", "lower the cap on Gaussians");
  adopt(model, nullptr);
  balance_ = {};
  reset_density_statistics();
}

void CpuEngine::adopt(const GaussianModel& model, const Moments* moments) {
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
    moments_.reset(model_);
  } else {
    take_in(moments->m, RowKind::kMoments, moments_.m);
    take_in(moments->v, RowKind::kMoments, moments_.v);
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

void CpuEngine::store(GaussianModel& model) const { model = expanded(model_); }

void CpuEngine::reset_density_statistics() {
  for (const NamedArray& a : arrays_of(statistics_)) a.values->assign(model_.size(), 0.0f);
}

void CpuEngine::save_state(EngineState& state) const {
  state.model = expanded(model_);
  Moments moments;
  moments.m = expanded(moments_.m);
  moments.v = expanded(moments_.v);
  DensityStatistics statistics = statistics_;
  state.arrays.clear();
  for (const NamedArray& a : arrays_of(moments.m)) state.arrays[std::string("adam_m.") + a.name] = std::move(*a.values);
  for (const NamedArray& a : arrays_of(moments.v)) state.arrays[std::string("adam_v.") + a.name] = std::move(*a.values);
  for (const NamedArray& a : arrays_of(statistics))
    state.arrays[std::string("density.") + a.name] = std::move(*a.values);
  // Bit for bit: a rounded value would make a resumed run differ in the last digits.
  const double running[2] = {balance_.photometric, balance_.semantic};
  std::vector<float>& balance = state.arrays["coupling.balance"];
  balance.resize(2 * sizeof(double) / sizeof(float));
  std::memcpy(balance.data(), running, sizeof(running));
}

void CpuEngine::load_state(const EngineState& state) {
  check_shape(state.model);
  // Everything is read before anything is replaced.
  Moments moments;
  moments.m = moments.v = state.model;
  for (const NamedArray& a : arrays_of(moments.m)) {
    *a.values = take(state, std::string("adam_m.") + a.name, a.values->size());
  }
  for (const NamedArray& a : arrays_of(moments.v)) {
    *a.values = take(state, std::string("adam_v.") + a.name, a.values->size());
  }
  DensityStatistics statistics;
  for (const NamedArray& a : arrays_of(statistics)) {
    *a.values = take(state, std::string("density.") + a.name, state.model.size());
  }
  const std::vector<float> balance = take(state, "coupling.balance", 2 * sizeof(double) / sizeof(float));
  constexpr size_t kShRow = 3 * kShCoefficients;
  for (size_t i = 0; i < moments.m.sh.size(); ++i) {
    if (moments.m.sh[i] != 0 || moments.v.sh[i] != 0) moments.sh_used = std::max(moments.sh_used, i % kShRow + 1);
  }
  adopt(state.model, &moments);
  statistics_ = std::move(statistics);
  double running[2];
  std::memcpy(running, balance.data(), sizeof(running));
  balance_ = {running[0], running[1]};
}

void CpuEngine::set_training_views(std::vector<TrainingView> views) {
  views_ = std::move(views);
  semantic_views_.assign(views_.size(), SemanticView());
  active_ = find_active_classes(views_, active_top_k_, *pool_);
  for (TrainingView& view : views_) compress_target(active_, *pool_, view.data.semantics);
  if (!active_.has_remainder() && !map_.has_remainder()) return;
  const GaussianModel model = expanded(model_);
  Moments moments;
  moments.m = expanded(moments_.m);
  moments.v = expanded(moments_.v);
  moments.sh_used = moments_.sh_used;
  adopt(model, &moments);
}

void CpuEngine::restructure(const RestructurePlan& plan) {
  for (const RowOrigin& row : plan.rows) {
    if (row.source >= model_.size()) {
      throw Error({ErrorKind::kFailed,
                   "a plan names row " + std::to_string(row.source) + " of " + std::to_string(model_.size()),
                   {},
                   "source",
                   "make the plan from this model"});
    }
  }
  restructure_model(plan, model_);
  rounded_for_.reset();
  for (GaussianModel* m : {&moments_.m, &moments_.v}) {
    for (const NamedArray& a : arrays_of(*m)) restructure_rows(plan, a.width, *a.values);
  }
  for (const NamedArray& a : arrays_of(statistics_)) restructure_rows(plan, a.width, *a.values);
  settle_memory();
}

void CpuEngine::reset_opacity(float maximum) {
  if (!(maximum > 0 && maximum < 1)) throw_usage("an opacity to reset to lies between 0 and 1");
  const float logit = std::log(maximum / (1 - maximum));
  for (float& x : model_.opacity_logits) x = std::min(x, logit);
  std::fill(moments_.m.opacity_logits.begin(), moments_.m.opacity_logits.end(), 0.0f);
  std::fill(moments_.v.opacity_logits.begin(), moments_.v.opacity_logits.end(), 0.0f);
}

}  // namespace aligngs::cpu
