// The engine on a CUDA device: orchestration of the operations in this folder, the twin of engine/cpu/cpu_engine.h.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "device/stage_timer.h"
#include "device/step_graph.h"
#include "engine/cuda/density.h"
#include "engine/cuda/device_frame.h"
#include "engine/cuda/engine_options.h"
#include "engine/cuda/model_arrays.h"
#include "engine/cuda/multi_view.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/semantic_visit.h"
#include "engine/cuda/step_outcome.h"
#include "engine/cuda/teacher_maps.h"
#include "engine/cuda/training_maps.h"
#include "engine/engine.h"
#include "engine/engine_arrays.h"
#include "engine/maps.h"
#include "engine/shared/active_classes.h"

namespace aligngs::cuda {

/// Everything of a step stays on the device. The host waits once per step, for the losses and whether they are finite.
/// It waits once more for a new view, to learn its number of (Gaussian, tile) pairs. Results are the same bits on every
/// run on one kind of device. Not to be used from several threads at once.
class CudaEngine final : public Engine {
 public:
  CudaEngine(int device, uint64_t budget_bytes, int threads, const CudaEngineOptions& options = {});

  void prepare(EngineInputs inputs) override;
  std::string device_name() const override { return name_; }
  void load(const GaussianModel& model) override;
  void store(GaussianModel& model) const override;
  void store_shapes(GaussianModel& model) const override;
  void save_state(EngineState& state) const override;
  void load_state(const EngineState& state) override;
  size_t size() const override { return model_.size(); }

  /// Throws Error{kResources} for more channels than the device's matrix products take (kMaxSemanticChannels).
  void set_training_views(std::vector<TrainingView> views) override;
  void set_pose(int view, const Rigidd& world_to_camera) override {
    views_.at(static_cast<size_t>(view)).camera.world_to_camera = world_to_camera;
  }
  bool offers_multi_view() const override { return true; }
  StepReport step(const StepRequest& request) override;

  DensityStatistics density_statistics() const override;
  void reset_density_statistics() override;
  void restructure(const RestructurePlan& plan) override;
  void reset_opacity(float maximum) override;
  void raise_scales(const std::vector<float>& log_floors) override;
  void add_position_noise(const PositionNoise& noise) override;

  Rendering render(const Camera& camera, const RenderOptions& options) const override;
  void lift_semantics(const RasterSettings& raster) override;
  std::optional<OwnMemory> own_memory(const std::vector<TrainingView>& views, int active_top) const override;
  uint64_t predicted_bytes(size_t gaussians, int channels, size_t pixels_per_view) const override;
  uint64_t predicted_host_bytes(size_t gaussians, int channels) const override;

  // For tests. Gradients and maps of the last step, until the next call of anything else; rows that the step did not
  // touch are zero.
  GaussianModel last_gradients() const;
  RenderMaps<float> last_maps() const;
  const CouplingBalance& coupling_balance() const { return balance_; }
  void set_coupling_balance(const CouplingBalance& balance) { balance_ = balance; }
  const DeviceContext& context() const { return *context_; }
  const StepGraph::Counts& graph_counts() const { return graph_->counts(); }

 private:
  /// Data of a view that a step needs.
  struct ViewOnDevice {
    Camera camera;
    TrainingMaps maps;
    TeacherMaps teacher;
    int teacher_channels = 0;  ///< 0: no semantics
    size_t pairs = 0;          ///< (Gaussian, tile) pairs at the last visit; 0: never visited
  };
  /// The arrays of the step in progress, in the arena.
  struct StepArrays {
    DeviceFrame frame;
    ModelSpans gradients;
    DeviceSpan<uint8_t> touched, semantic_written;
    DeviceSpan<float> semantic_gradients;
    DeviceSpan<StepOutcome> outcome;
    bool semantics = false;
  };
  /// Data that the host reads back at the end of a step.
  struct ReadBack {
    StepOutcome outcome;
    BinCounts counts;
    BinCounts neighbour_counts;  ///< zero without a neighbour
    PoseGradient<double> pose;   ///< zero where it was not asked for
  };
  struct FrameRequest {
    const Camera& camera;
    RasterSettings raster;
    int sh_degree = 0;
    bool geometry = false;  ///< maps beside colour and alpha
    bool record = false;    ///< what the backward passes need
    size_t pairs = 0;       ///< of the last visit; 0: waits to learn how many there are
    bool stages = true;     ///< the timer records projection and lists
  };

  /// Gradients of the losses of the semantic rows and of the coupling.
  struct SemanticStep {
    DeviceSpan<CouplingMoments> coupling;
    DeviceSpan<uint8_t> seen;
    DeviceSpan<float> row_slots;
    DeviceSpan<double> terms;
  };

  /// Empties the arena, then projects and bins a view.
  DeviceFrame make_frame(const FrameRequest& request) const;
  /// The view of `request.neighbour`, or nullptr for a step without multi-view terms.
  ViewOnDevice* neighbour_of(const StepRequest& request);
  /// Puts the depth of the neighbour on the stream, and the copy of its counts to read_back_. Empties the arena.
  NeighbourSpans render_neighbour(const StepRequest& request, const ViewOnDevice& view);
  /// Puts a whole step on the stream, the copy of its outcome to read_back_ included. Waits where view.pairs == 0.
  void enqueue_step(const StepRequest& request, const ViewOnDevice& view, float coupling_scale);
  ReadBack run_step(const StepRequest& request, const ViewOnDevice& view, float coupling_scale);
  SemanticStep visit_semantics(const StepRequest& request, const ViewOnDevice& view);
  bool semantics_active(const StepRequest& request, const ViewOnDevice& view) const;
  /// The parameter behind a non-finite value: the first one that is not finite itself, else the symptom.
  NonFinite locate(NonFinite symptom) const;
  /// Takes a model of all classes in, moments of the same shape or nullptr for zeros.
  void adopt(const GaussianModel& model, const AdamMoments* moments);
  GaussianModel expanded(const ModelArrays& rows) const;  ///< to all classes
  AdamMoments expanded_moments() const;
  DensitySpans density_spans();
  void resize_statistics(size_t gaussians);

  CudaEngineOptions options_;
  std::unique_ptr<DeviceContext> context_;  ///< outlives every array
  std::unique_ptr<ThreadPool> pool_;
  std::string name_;
  ModelArrays model_, m_, v_;
  DeviceArray<float> semantic_updates_;  ///< [N]
  int sh_degree_ = 0;
  size_t sh_used_ = 3;  ///< spherical harmonics beyond this many numbers per row have zero moments
  static constexpr size_t kStatistics = 7;
  mutable DeviceArray<float> statistics_[kStatistics];  ///< in the order of arrays_of(DensityStatistics&)
  CouplingBalance balance_;
  std::vector<ViewOnDevice> views_;

  DeviceArray<float> neighbour_depth_;             ///< of the step in progress
  DeviceArray<unsigned long long> neighbour_bad_;  ///< [1]

  int active_top_ = 0;    ///< EngineInputs
  ActiveClasses active_;  ///< of the training views, whose targets hold its channels
  ActiveClasses map_;     ///< of the model: active_ or, for another number of classes, none

  mutable DeviceArena arena_;
  std::unique_ptr<PinnedMemory> read_back_;
  std::unique_ptr<StageTimer> timer_;  ///< runs during steps alone
  std::unique_ptr<StepGraph> graph_;
  StepArrays last_;
};

}  // namespace aligngs::cuda
