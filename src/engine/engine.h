// The compute seam: one implementation per device. Everything a training run asks of a device goes
// through this interface; src/engine/cpu implements it, src/engine/reference specifies it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "engine/formulas/pose_gradient.h"
#include "engine/formulas/position_noise.h"
#include "engine/loss_terms.h"
#include "engine/settings.h"
#include "engine/training_view.h"
#include "gaussians/density_control.h"
#include "gaussians/gaussian_model.h"

namespace aligngs {

/// The place where a non-finite value appeared first; the step was rolled back.
struct NonFinite {
  bool found = false;
  int64_t gaussian = -1;  ///< row, or -1 when the value is a loss
  std::string term;       ///< loss term or parameter name
};

struct StepReport {
  LossTerms losses;
  size_t visible = 0;  ///< Gaussians that touched a pixel
  NonFinite non_finite;
  double coupling_scale = 0;  ///< factor by which the semantic geometry gradient was multiplied (is_balanced)
  /// The gradient of all losses of the view, the coupling included; the multi-view terms count as far as the Gaussians
  /// carry them. Zero without StepRequest::pose_gradient and after a step that was rolled back.
  PoseGradient<double> pose;
  std::map<std::string, double> seconds;  ///< wall time of each stage that had something to do
};

struct RenderOptions {
  RasterSettings raster;
  SemanticBlend semantic_blend = SemanticBlend::kProbabilities;
  bool geometry = true;  ///< normal and depth maps
  bool labels = false;   ///< arg-max label and its probability
  /// Nothing but depth_median is asked for: an engine may leave out all other maps.
  bool median_only = false;
};

/// Maps are at the camera's size. "Nothing here" is alpha < 0.5, never a class and never a depth.
struct Rendering {
  ImageF color;              ///< H x W x 3, not clamped
  ImageF alpha;              ///< H x W
  ImageF normal;             ///< H x W x 3, camera frame, unit where alpha > 0
  ImageF depth_plane;        ///< H x W, unbiased plane depth with guards (formulas/plane_depth.h), 0 = invalid
  ImageF depth_median;       ///< H x W, depth of the first intersection with transmittance < 0.5, 0 = none
  ImageF depth_expected;     ///< H x W, alpha-normalised mean of intersection depths, 0 = none
  Image<uint16_t> label;     ///< H x W, kNoLabel where alpha < 0.5
  ImageF label_probability;  ///< H x W
};

/// Complete state of an engine, for checkpoints: named flat arrays, model and optimiser alike.
struct EngineState {
  GaussianModel model;
  std::map<std::string, std::vector<float>> arrays;  ///< moments ("adam_m.positions"), statistics, running values
};

/// Memory that an engine works in beside the host's, as a device has.
struct OwnMemory {
  uint64_t limit = 0;  ///< bytes that a run may take of it
  uint64_t views = 0;  ///< bytes of it that the views asked about will take
  int channels = 0;    ///< numbers per semantic row there (active_top); 0: as many as there are classes
};

/// Views and rows of an engine from its first step on.
struct EngineInputs {
  std::vector<TrainingView> views;
  /// Classes that no view's teacher ranks among its so many best at any pixel may be carried as one channel that
  /// represents them all. Everything that goes in and out keeps every class. 0, or an engine that does not offer it:
  /// every class has a channel of its own.
  int active_top = 0;
  const GaussianModel* model = nullptr;  ///< to begin with, as load() takes it; null: load_state() brings one
};

class Engine {
 public:
  virtual ~Engine() = default;

  virtual std::string device_name() const = 0;
  /// Everything that comes before the first step of a training. Rendering alone needs no more than load().
  virtual void prepare(EngineInputs inputs) = 0;
  virtual void load(const GaussianModel& model) = 0;  ///< resets moments and statistics
  virtual void store(GaussianModel& model) const = 0;
  /// Positions, scales, rotations and opacities alone, the other arrays empty: what density control and pruning decide
  /// on. With 150 classes they are a twentieth of the model.
  virtual void store_shapes(GaussianModel& model) const = 0;
  virtual void save_state(EngineState& state) const = 0;
  virtual void load_state(const EngineState& state) = 0;
  virtual size_t size() const = 0;

  /// Whether steps may have a neighbour; if not, step() throws Error{kUsage} for one that has multi-view terms.
  virtual bool offers_multi_view() const { return false; }
  /// Other views than those before, as at another resolution; classes and rows stay.
  virtual void set_training_views(std::vector<TrainingView> views) = 0;
  /// Moves the camera of a training view; its size and intrinsics stay. Before the step that is to see it there.
  virtual void set_pose(int view, const Rigidd& world_to_camera) = 0;
  /// Forward, losses, backward, optimiser for one view. On a non-finite value the parameters and moments
  /// are as before the call and report.non_finite says where.
  virtual StepReport step(const StepRequest& request) = 0;

  /// Inputs of density control; see gaussians/density_control.h.
  virtual DensityStatistics density_statistics() const = 0;
  virtual void reset_density_statistics() = 0;
  /// Keeps, copies and makes rows as the plan says; moments follow their rows, new rows start at zero.
  virtual void restructure(const RestructurePlan& plan) = 0;
  /// Caps opacities at the given value and zeroes their moments (3DGS opacity reset).
  virtual void reset_opacity(float maximum) = 0;

  /// The two larger scales of row i become at least exp(log_floors[i]) (formulas/shape_terms.h); moments stay.
  /// Error{kFailed} for another number of floors than rows.
  virtual void raise_scales(const std::vector<float>& log_floors) = 0;

  /// Moves positions as formulas/position_noise.h says; moments stay.
  virtual void add_position_noise(const PositionNoise& noise) = 0;

  virtual Rendering render(const Camera& camera, const RenderOptions& options) const = 0;

  /// Closed-form semantic start: s_i = log(sum_u w_i(u) t(u) + eps) - row mean over all
  /// training views. Rows that no pixel sees stay zero.
  virtual void lift_semantics(const RasterSettings& raster) = 0;

  /// Its own memory, and the part that prepare() will take for such views and active_top. Nothing: the engine works in the host's
  /// memory.
  virtual std::optional<OwnMemory> own_memory(const std::vector<TrainingView>& /*views*/, int /*active_top*/) const {
    return {};
  }
  /// Bytes that n Gaussians of C channels, their optimiser and a step need in the engine's memory. Views that it does
  /// not have yet are left out.
  virtual uint64_t predicted_bytes(size_t gaussians, int channels, size_t pixels_per_view) const = 0;
  /// For an engine with memory of its own: host bytes for copies, at the peak of writing a checkpoint.
  virtual uint64_t predicted_host_bytes(size_t /*gaussians*/, int /*channels*/) const { return 0; }
};

/// The multi-threaded float engine. threads == 0: all hardware threads.
std::unique_ptr<Engine> make_cpu_engine(int threads = 0);

}  // namespace aligngs
