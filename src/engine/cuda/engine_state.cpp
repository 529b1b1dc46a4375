// Loading, storing and restructuring the state of the engine.
#include <iterator>
#include <string>
#include <utility>

#include "core/error.h"
#include "engine/cuda/cuda_engine.h"
#include "engine/cuda/memory_forecast.h"
#include "engine/cuda/optimiser.h"
#include "engine/cuda/restructure.h"
#include "engine/cuda/semantic_rows.h"
#include "engine/cuda/semantic_visit.h"

namespace aligngs::cuda {

void CudaEngine::load(const GaussianModel& model) {
  check_model(model);
  adopt(model, nullptr);
  balance_ = {};
  reset_density_statistics();
}

void CudaEngine::adopt(const GaussianModel& model, const AdamMoments* moments) {
  map_ = active_.has_remainder() && active_.classes == model.semantic_channels ? active_ : ActiveClasses();
  last_ = {};
  graph_->drop();
  const auto take_in = [&](const GaussianModel& from, RowKind kind, const char* what, ModelArrays& to) {
    if (!map_.has_remainder()) {
      to.upload(*context_, from, what);
      return;
    }
    GaussianModel rows = from;
    rows.semantics = compress_rows(map_, kind, from.semantics);
    rows.semantic_channels = map_.channels();
    to.upload(*context_, rows, what);
  };
  take_in(model, RowKind::kLogits, "the Gaussians", model_);
  sh_degree_ = model.sh_degree;
  if (moments != nullptr) {
    take_in(moments->m, RowKind::kMoments, "the optimiser's moments", m_);
    take_in(moments->v, RowKind::kMoments, "the optimiser's moments", v_);
    semantic_updates_.assign(*context_, moments->semantic_updates, "the optimiser's moments");
    sh_used_ = moments->sh_used;
    return;
  }
  for (ModelArrays* moment : {&m_, &v_}) {
    moment->resize(*context_, model_.size(), model_.channels(), "the optimiser's moments");
    moment->set_zero(*context_);
  }
  semantic_updates_.resize(*context_, model_.size(), "the optimiser's moments");
  fill_zero(*context_, semantic_updates_.span());
  sh_used_ = 3;
}

AdamMoments CudaEngine::expanded_moments() const {
  return {expanded(m_), expanded(v_), semantic_updates_.to_host(), sh_used_};
}

GaussianModel CudaEngine::expanded(const ModelArrays& rows) const {
  GaussianModel out;
  rows.download(out);
  out.sh_degree = sh_degree_;
  if (!map_.has_remainder()) return out;
  out.semantics = expand_rows(map_, out.semantics);
  out.semantic_channels = map_.classes;
  return out;
}

void CudaEngine::store(GaussianModel& model) const { model = expanded(model_); }

void CudaEngine::store_shapes(GaussianModel& model) const {
  model = {};
  model.sh_degree = sh_degree_;
  model_.download_shapes(model);
}

void CudaEngine::resize_statistics(size_t gaussians) {
  for (DeviceArray<float>& a : statistics_) a.resize(*context_, gaussians, "density statistics");
}

void CudaEngine::reset_density_statistics() {
  resize_statistics(model_.size());
  for (DeviceArray<float>& a : statistics_) fill_zero(*context_, a.span());
}

DensitySpans CudaEngine::density_spans() {
  return {statistics_[0].span(), statistics_[1].span(), statistics_[2].span(), statistics_[3].span(),
          statistics_[4].span(), statistics_[5].span(), statistics_[6].span()};
}

DensityStatistics CudaEngine::density_statistics() const {
  DensityStatistics out;
  size_t k = 0;
  for (const NamedArray& a : arrays_of(out)) *a.values = statistics_[k++].to_host();
  return out;
}

void CudaEngine::save_state(EngineState& state) const {
  EngineMemory memory;
  memory.moments = expanded_moments();
  memory.statistics = density_statistics();
  memory.balance = balance_;
  pack_state(expanded(model_), std::move(memory), state);
}

void CudaEngine::load_state(const EngineState& state) {
  EngineMemory memory = unpack_state(state);  // everything is read before anything is replaced
  adopt(state.model, &memory.moments);
  resize_statistics(model_.size());
  size_t k = 0;
  for (const NamedArray& a : arrays_of(memory.statistics)) upload(*context_, statistics_[k++].span(), a.values->data());
  balance_ = memory.balance;
}

void CudaEngine::prepare(EngineInputs inputs) {
  active_top_ = inputs.active_top;
  set_training_views(std::move(inputs.views));
  if (inputs.model) load(*inputs.model);
}

void CudaEngine::set_training_views(std::vector<TrainingView> views) {
  active_ = find_active_classes(views, active_top_, *pool_);
  graph_->drop();
  views_.clear();
  for (TrainingView& view : views) {
    const SemanticTarget& target = view.data.semantics;
    compress_target(active_, *pool_, view.data.semantics);
    if (!target.empty()) check_semantic_channels(*context_, target.channels);
    ViewOnDevice on_device;
    on_device.camera = view.data.camera;
    on_device.maps = TrainingMaps(*context_, view);
    if (!target.empty()) {
      SemanticView cache;
      prepare_semantic_view(view, target.channels - (active_.has_remainder() ? 1 : 0), *pool_, cache);
      on_device.teacher = TeacherMaps(*context_, view, cache);
      on_device.teacher_channels = target.channels;
    }
    views_.push_back(std::move(on_device));
    view = {};
  }
  if (!active_.has_remainder() && !map_.has_remainder()) return;
  const AdamMoments moments = expanded_moments();
  adopt(expanded(model_), &moments);
}

void CudaEngine::restructure(const RestructurePlan& plan) {
  check_plan(plan, model_.size());
  last_ = {};
  graph_->drop();
  arena_.release();  // rows and their copies need the room
  const size_t before = model_.size();
  const DevicePlan device_plan(*context_, plan);
  restructure_model(*context_, device_plan, model_);
  restructure_moment(*context_, device_plan, m_);
  restructure_moment(*context_, device_plan, v_);
  restructure_numbers(*context_, device_plan, semantic_updates_);
  for (DeviceArray<float>& a : statistics_) restructure_numbers(*context_, device_plan, a);
  if (before == 0) return;
  for (ViewOnDevice& view : views_) {  // more rows, more pairs: in proportion, as a guess that a repeated step corrects
    view.pairs = view.pairs * model_.size() / before;
  }
}

void CudaEngine::reset_opacity(float maximum) {
  (void)reset_logit(maximum);  // checks the range
  cap_opacities(*context_, maximum, {model_.spans(), m_.spans(), v_.spans(), {}});
}

void CudaEngine::add_position_noise(const PositionNoise& noise) {
  if (noise.rate != 0) cuda::add_position_noise(*context_, noise, model_.spans());
}

void CudaEngine::raise_scales(const std::vector<float>& log_floors) {
  check_floors(log_floors, model_.size());
  DeviceArray<float> floors;
  floors.assign(*context_, log_floors, "floors of scales");
  cuda::raise_scales(*context_, floors.span(), model_.spans());
  context_->synchronise();  // the floors go
}

std::optional<OwnMemory> CudaEngine::own_memory(const std::vector<TrainingView>& views, int active_top) const {
  const ActiveClasses active = find_active_classes(views, active_top, *pool_);
  OwnMemory own;
  own.limit = context_->budget();
  if (active.has_remainder()) own.channels = active.channels();
  for (const TrainingView& view : views) {
    own.views += TrainingMaps::bytes(view);
    const SemanticTarget& target = view.data.semantics;
    if (target.empty()) continue;
    own.views += TeacherMaps::bytes(active.has_remainder() ? active.channels() : target.channels,
                                    static_cast<size_t>(target.width) * static_cast<size_t>(target.height),
                                    view.data.color.pixels());
  }
  return own;
}

uint64_t CudaEngine::predicted_bytes(size_t gaussians, int channels, size_t pixels_per_view) const {
  return forecast_bytes(
      {gaussians, channels, pixels_per_view, options_.blend_backward == BlendBackwardMethod::kPerSplat});
}

uint64_t CudaEngine::predicted_host_bytes(size_t gaussians, int channels) const {
  const uint64_t state = 3 * ModelArrays::bytes(gaussians, channels) + kStatistics * sizeof(float) * gaussians;
  return 2 * state;  // once as it comes from the device, once as bytes of the file
}

}  // namespace aligngs::cuda
