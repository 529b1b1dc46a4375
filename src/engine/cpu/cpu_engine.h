// The multi-threaded float engine: orchestration of the operations in this folder.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "engine/cpu/optimiser.h"
#include "engine/cpu/parameter_gradients.h"
#include "engine/engine.h"
#include "engine/formulas/semantic_loss.h"
#include "engine/losses/map_losses.h"
#include "engine/shared/active_classes.h"

namespace aligngs::cpu {

/// One view on its way through a step or a rendering. Kept from step to step for its memory.
struct ViewFrame {
  ProjectedView view;
  TileLists lists;
  RenderMaps<float> maps;
  BlendRecord record;
  AlignedArray<float> features;  ///< [visible][padded] semantic rows as they are blended
};

/// How the semantic products of a training step are formed.
enum class SemanticProducts {
  kAutomatic,  ///< kBfloat16 where the machine has AMX, else kFloat32
  kFloat32,    ///< float32 vectors, within float rounding of the reference
  kBfloat16    ///< bfloat16 operands and float32 sums on AMX
};

/// Results do not depend on the number of threads. Not to be used from several threads at once, rendering included:
/// all calls share the scratch memory.
class CpuEngine final : public Engine {
 public:
  explicit CpuEngine(int threads);

  void prepare(EngineInputs inputs) override;
  std::string device_name() const override;
  void load(const GaussianModel& model) override;
  void store(GaussianModel& model) const override;
  void store_shapes(GaussianModel& model) const override;
  void save_state(EngineState& state) const override;
  void load_state(const EngineState& state) override;
  size_t size() const override { return model_.size(); }

  bool offers_multi_view() const override { return true; }
  void set_pose(int view, const Rigidd& world_to_camera) override {
    views_.at(static_cast<size_t>(view)).data.camera.world_to_camera = world_to_camera;
  }
  void set_training_views(std::vector<TrainingView> views) override;
  StepReport step(const StepRequest& request) override;

  DensityStatistics density_statistics() const override { return statistics_; }
  void reset_density_statistics() override;
  void restructure(const RestructurePlan& plan) override;
  void reset_opacity(float maximum) override;
  void raise_scales(const std::vector<float>& log_floors) override;
  void add_position_noise(const PositionNoise& noise) override;

  Rendering render(const Camera& camera, const RenderOptions& options) const override;
  void lift_semantics(const RasterSettings& raster) override;
  uint64_t predicted_bytes(size_t gaussians, int channels, size_t pixels_per_view) const override;

  /// Throws Error{kUsage} when kBfloat16 is asked for on a machine without AMX.
  void set_semantic_products(SemanticProducts products);

  /// Gradients of the last step, for tests: rows that the step did not touch are zero. Semantic rows have the model's
  /// channels (ActiveClasses). Needs keep_features(true) before the step.
  GaussianModel last_gradients() const;
  /// Steps that round the blended rows keep the exact ones, too, which only last_gradients reads.
  void keep_features(bool keep) { keep_features_ = keep; }
  const RenderMaps<float>& last_maps() const { return frame_.maps; }
  const CouplingBalance& coupling_balance() const { return balance_; }
  /// For tests that compare one step's gradients: starts from a given balance.
  void set_coupling_balance(const CouplingBalance& balance) { balance_ = balance; }

 private:
  void prepare_frame(const Camera& camera, const RasterSettings& raster, int sh_degree) const;
  /// Rows of Gaussians in view, or only those with touched[row] == 1.
  void prepare_features(SemanticBlend blend, const uint8_t* touched) const;
  /// Fills rounded_, unless it holds what this blend needs of the model as it is: false.
  bool prepare_rounded(SemanticBlend blend);
  /// Takes a model of all classes in, moments of the same shape or nullptr for zeros.
  void adopt(const GaussianModel& model, const AdamMoments* moments);
  GaussianModel expanded(const GaussianModel& rows) const;  ///< to all classes
  AdamMoments expanded_moments() const;
  bool has_moments() const { return !moments_.m.opacity_logits.empty(); }
  AdamMoments& moments_for_step();
  void settle_memory();  ///< large pages for parameters and moments
  bool semantics_active(const StepRequest& request);
  /// Renders the neighbour's plane depth into loss_workspace_. False when a Gaussian in its view is not finite.
  bool render_neighbour(const StepRequest& request);
  int64_t first_bad_feature_gradient() const;  ///< row of the model, or -1
  /// The parameter behind a non-finite value: the first one that is not finite itself, else the symptom.
  NonFinite locate(NonFinite symptom) const;

  std::unique_ptr<ThreadPool> pool_;
  GaussianModel model_;
  AdamMoments moments_;  ///< empty until the first step: zeros that an engine which only renders does not hold
  DensityStatistics statistics_;
  CouplingBalance balance_;  ///< rounded to float, so that a checkpoint holds it exactly
  std::vector<TrainingView> views_;
  std::vector<SemanticView> semantic_views_;

  int active_top_ = 0;    ///< EngineInputs
  ActiveClasses active_;  ///< of the training views, whose targets hold its channels
  ActiveClasses map_;     ///< of the model: active_ or, for another number of classes, none
  ClassCounts counts_;    ///< of the model's channels
  SemanticProducts products_ = SemanticProducts::kAutomatic;

  /// [N][padded_depth] semantic rows as the products on AMX tiles read them; steps keep them up to date.
  AlignedArray<uint16_t> rounded_;
  std::optional<SemanticBlend> rounded_for_;  ///< empty: rows of rounded_ are not those of the model

  // Scratch, kept between calls.
  mutable ViewFrame frame_;
  mutable std::vector<TileScratch> scratch_;
  mutable RowBatches batches_;
  MapGradients<float> map_gradients_;
  MapLossWorkspace<float> loss_workspace_;
  std::vector<float> residual_;
  SlotGradients slots_;
  ParameterGradients gradients_;
  AlignedArray<float> feature_gradients_;  ///< [visible][padded] dL/dfeatures, rows with feature_written_ only
  std::vector<uint8_t> feature_written_;
  bool keep_features_ = false;
  bool last_semantics_ = false, last_probabilities_ = false;
};

}  // namespace aligngs::cpu
