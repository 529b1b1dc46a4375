// For tests: an engine whose steps are cheap arithmetic but whose state has every part a real one has.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "engine/engine.h"
#include "gaussians/restructure.h"
#include "scene/triangle_mesh.h"

namespace aligngs::test_train {

class FakeEngine final : public Engine {
 public:
  /// Called with each step's number; the result is put into the report. For injecting failures.
  std::function<NonFinite(int64_t step)> before_step;
  /// Result of own_memory().
  std::optional<OwnMemory> memory;

  std::string device_name() const override { return "fake"; }
  void prepare(EngineInputs inputs) override {
    set_training_views(std::move(inputs.views));
    if (inputs.model) load(*inputs.model);
  }
  void load(const GaussianModel& model) override {
    model_ = model;
    moments_.assign(model.positions.size(), 0);
    running_ = 0;
    reset_density_statistics();
  }
  void store(GaussianModel& model) const override { model = model_; }
  void store_shapes(GaussianModel& model) const override {
    model = model_;
    model.sh.clear();
    model.semantics.clear();
    model.semantic_channels = 0;
  }
  void save_state(EngineState& state) const override {
    state.model = model_;
    state.arrays = {
        {"adam_m.positions", moments_}, {"gradient", gradient_}, {"visible", visible_}, {"running", {running_}}};
  }
  void load_state(const EngineState& state) override {
    model_ = state.model;
    moments_ = state.arrays.at("adam_m.positions");
    gradient_ = state.arrays.at("gradient");
    visible_ = state.arrays.at("visible");
    running_ = state.arrays.at("running").at(0);
  }
  size_t size() const override { return model_.size(); }
  void set_pose(int view, const Rigidd& world_to_camera) override {
    views_.at(static_cast<size_t>(view)).data.camera.world_to_camera = world_to_camera;
  }
  void set_training_views(std::vector<TrainingView> views) override { views_ = std::move(views); }

  StepReport step(const StepRequest& request) override {
    StepReport report;
    if (before_step) report.non_finite = before_step(request.step);
    if (report.non_finite.found) return report;
    running_ = 0.9f * running_ + 0.1f * static_cast<float>(request.view + 1) * request.losses.prior_depth_scale;
    for (size_t i = 0; i < model_.positions.size(); ++i) {
      const float gradient = std::sin(model_.positions[i] * 7 + static_cast<float>(request.view)) + running_;
      moments_[i] = request.adam.beta1 * moments_[i] + (1 - request.adam.beta1) * gradient;
      model_.positions[i] -= request.rates.position * moments_[i];
    }
    for (float& s : model_.semantics) s += 0.01f * static_cast<float>(request.view + 1);
    model_.sh_degree = request.sh_degree;
    if (request.collect_density) {
      for (size_t i = 0; i < size(); ++i) {
        gradient_[i] += 1e-3f * std::abs(moments_[3 * i]);
        visible_[i] += 1;
      }
    }
    report.visible = size();
    report.losses.total = std::abs(running_);
    report.losses.psnr = 20 + running_;
    return report;
  }

  DensityStatistics density_statistics() const override {
    DensityStatistics s;
    s.gradient = gradient_;
    s.visible = s.weight = visible_;
    s.gradient_abs = s.radius = s.residual = s.unsupported = std::vector<float>(size(), 0);
    return s;
  }
  void reset_density_statistics() override {
    gradient_.assign(size(), 0);
    visible_.assign(size(), 0);
  }
  void restructure(const RestructurePlan& plan) override {
    restructure_model(plan, model_);
    restructure_rows(plan, 3, moments_);
    restructure_rows(plan, 1, gradient_);
    restructure_rows(plan, 1, visible_);
  }
  void reset_opacity(float maximum) override {
    for (float& o : model_.opacity_logits) o = std::min(o, std::log(maximum / (1 - maximum)));
  }
  void add_position_noise(const PositionNoise& noise) override {
    for (float& x : model_.positions) x += 1e-3f * noise.rate;
  }
  void raise_scales(const std::vector<float>& log_floors) override {
    for (size_t i = 0; i < log_floors.size(); ++i) {
      for (size_t k = 0; k < 3; ++k)
        model_.log_scales[3 * i + k] = std::max(model_.log_scales[3 * i + k], log_floors[i]);
    }
  }
  Rendering render(const Camera& camera, const RenderOptions&) const override {
    Rendering r;
    r.depth_median = ImageF(camera.width, camera.height, 1, 0.0f);  // sees nothing, so it prunes nothing
    r.color = ImageF(camera.width, camera.height, 3);
    r.alpha = ImageF(camera.width, camera.height, 1);
    r.label = Image<uint16_t>(camera.width, camera.height, 1, kNoLabel);
    return r;
  }
  void lift_semantics(const RasterSettings&) override {
    for (size_t i = 0; i < model_.semantics.size(); ++i) model_.semantics[i] = static_cast<float>(i % 3);
  }
  static constexpr uint64_t bytes(uint64_t gaussians, int channels) {
    return gaussians * (59 + static_cast<uint64_t>(channels)) * 12;
  }
  std::optional<OwnMemory> own_memory(const std::vector<TrainingView>&, int) const override { return memory; }
  uint64_t predicted_bytes(size_t gaussians, int channels, size_t) const override { return bytes(gaussians, channels); }
  uint64_t predicted_host_bytes(size_t gaussians, int channels) const override {
    return bytes(gaussians, channels) / 2;
  }

 private:
  GaussianModel model_;
  std::vector<TrainingView> views_;
  std::vector<float> moments_, gradient_, visible_;
  float running_ = 0;
};

}  // namespace aligngs::test_train
