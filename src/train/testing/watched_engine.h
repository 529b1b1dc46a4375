// For tests: an engine around another one that calls back after each step, to look or to die there.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "engine/engine.h"

namespace aligngs::test_train {

class WatchedEngine final : public Engine {
 public:
  using AfterStep = std::function<void(const StepRequest&)>;

  WatchedEngine(std::unique_ptr<Engine> engine, AfterStep after_step)
      : engine_(std::move(engine)), after_step_(std::move(after_step)) {}
  StepReport step(const StepRequest& request) override {
    StepReport report = engine_->step(request);
    after_step_(request);
    return report;
  }
  std::string device_name() const override { return engine_->device_name(); }
  void load(const GaussianModel& model) override { engine_->load(model); }
  void store(GaussianModel& model) const override { engine_->store(model); }
  void store_shapes(GaussianModel& model) const override { engine_->store_shapes(model); }
  void save_state(EngineState& state) const override { engine_->save_state(state); }
  void load_state(const EngineState& state) override { engine_->load_state(state); }
  size_t size() const override { return engine_->size(); }
  void prepare(EngineInputs inputs) override { engine_->prepare(std::move(inputs)); }
  bool offers_multi_view() const override { return engine_->offers_multi_view(); }
  void set_pose(int view, const Rigidd& world_to_camera) override { engine_->set_pose(view, world_to_camera); }
  void set_training_views(std::vector<TrainingView> views) override { engine_->set_training_views(std::move(views)); }
  DensityStatistics density_statistics() const override { return engine_->density_statistics(); }
  void reset_density_statistics() override { engine_->reset_density_statistics(); }
  void restructure(const RestructurePlan& plan) override { engine_->restructure(plan); }
  void reset_opacity(float maximum) override { engine_->reset_opacity(maximum); }
  void add_position_noise(const PositionNoise& noise) override { engine_->add_position_noise(noise); }
  void raise_scales(const std::vector<float>& log_floors) override { engine_->raise_scales(log_floors); }
  Rendering render(const Camera& camera, const RenderOptions& o) const override { return engine_->render(camera, o); }
  void lift_semantics(const RasterSettings& raster) override { engine_->lift_semantics(raster); }
  std::optional<OwnMemory> own_memory(const std::vector<TrainingView>& views, int active_top) const override {
    return engine_->own_memory(views, active_top);
  }
  uint64_t predicted_bytes(size_t n, int channels, size_t pixels) const override {
    return engine_->predicted_bytes(n, channels, pixels);
  }
  uint64_t predicted_host_bytes(size_t n, int channels) const override {
    return engine_->predicted_host_bytes(n, channels);
  }

 private:
  std::unique_ptr<Engine> engine_;
  AfterStep after_step_;
};

/// Simulates kill -9: thrown in the middle of a step, nothing is written after it.
struct Killed {};
inline WatchedEngine::AfterStep killed_at(int64_t step) {
  return [step](const StepRequest& request) {
    if (request.step == step) throw Killed{};
  };
}

}  // namespace aligngs::test_train
