// Every setting of a training run. The keys, ranges, presets and one-line documentation of these fields are in one
// table (config_keys.h); nothing here has a value until a preset fills it.
//
// Lengths are shares of the robust scene extent E (scene/scene.h), so a similarity transform of the
// scene changes nothing. Iteration counts marked [ref] are counted in a run of
// train.reference_iterations (7000) and scale with the run's length.
#pragma once

#include <cstdint>
#include <string>

#include "train/config_choices.h"

namespace aligngs {

struct DataConfig {
  double scale = 1;  ///< working resolution / image resolution
  PriorDepthUse prior_depth = PriorDepthUse::kAuto;
  bool measure_depth = false;   ///< `run`: depth by multi-view stereo where the scene has points and no prior depth
  bool bare_planes = false;     ///< bare surfaces lie on planes of what was measured
  bool refine_cameras = false;  ///< `run` and `demo`: correct cameras and prior depth before training
  bool refine_stereo = false;   ///< and the depth by multi-view stereo
  bool refine_planes = false;   ///< and by the planes of walls, floor and ceiling
  bool refine_tables = false;   ///< and of tables, desks and counters
  bool refine_fused_labels = false;  ///< which are found by the labels of most photos
  bool refine_square = false;        ///< and turned to the axes of the room
  bool refine_panels = false;        ///< and panes, mirrors, screens and pictures by planes of their own
  bool refine_screens = false;       ///< of those, televisions and monitors by their outlines in several photos
  bool prior_confidence = true;      ///< weigh prior depth by pred_confidence/ where there is one
  std::string ignore;                ///< classes whose pixels are left out, with commas (scene/ignored_classes.h)
  bool semantics = true;             ///< use segmentation_logits/ when every training view has them
  bool sensor_exposure = false;      ///< `run`: measure exposures from depth of a sensor, or given depth
  bool sensor_cameras = false;       ///< `run`: correct the cameras that come with depth of a sensor
  bool clean_depth = false;          ///< and leave out pixels of that depth that mix two surfaces
  bool fill_depth = false;           ///< and fill holes of that depth by stereo
  bool refine_exposure = false;      ///< `run` and `demo`: measure the photos' exposures there
  bool exposure = false;             ///< undo what exposure.json says of the photos' exposures
  bool scores_as_logits = false;     ///< softmax the teacher's numbers whatever priors.json calls them
  double score_gamma = 1;            ///< exponent of the calibration of score teachers
  double least_score_sum = 0;        ///< of a pixel, below which it says nothing
};

struct InitConfig {
  StartSource start = StartSource::kAuto;
  double depth_opacity = 0, depth_flat_ratio = 0;  ///< of a start from prior depth
  double single_view_opacity = 0;                  ///< of prior depth that only one view confirms
  double cloud_opacity = 0, cloud_flat_ratio = 0;  ///< of a start from the point cloud (flat only with normals)
  double voxel_footprints = 0;     ///< edge of the thinning cubes in pixel footprints at the median depth
  double scale_max = 0;            ///< largest initial scale / E; 0 = none
  int64_t max_gaussians = 0;       ///< N0 is thinned to this many
  double gaussians_per_pixel = 0;  ///< and to this many per pixel of the largest training view; 0 = no such limit
  bool far_shell = false;          ///< and of a sensor's: points behind the room where it measured nothing
  int64_t random_count = 0;        ///< points of a random start
};

struct RunConfig {
  Preset preset = Preset::kDefault;  ///< that these settings began as
  int64_t iterations = 0;
  int64_t reference_iterations = 0;  ///< the run length in which [ref] keys are counted
  int64_t schedule_iterations = 0;   ///< length of the schedules; 0 = iterations. Pinned when a run is extended.
  int64_t seed = 0;
  /// highest degree; -1: by the number of training views and who made the cameras (Schedule::request)
  int64_t sh_degree = 0;
  int64_t sh_every = 0;              ///< [ref] one degree more after so many
  double coarse_scale = 1;           ///< resolution of the first steps / working resolution; 1 = all steps are alike
  int64_t coarse_stop = 0;           ///< [ref] steps at that resolution
  double near_plane = 0;             ///< / E
  double opacity_dropout = 0;        ///< share of the Gaussians left out of a step at the end of the schedule
  int64_t opacity_dropout_stop = 0;  ///< [ref] the last step that leaves any out
  bool closed_room = false;          ///< finish with the unseen parts of walls, floor and ceiling
  bool random_background = false;    ///< a new colour behind the scene every step; false: black
  double near_share = 0;             ///< / smallest metric prior depth of the view; 0 = off
  int64_t log_every = 0;             ///< iterations between lines of events.ndjson
};

struct LossConfig {
  double l1 = 0, ssim = 0, flatten = 0;
  double pearson = 0, log_depth = 0, log_depth_end = 0, log_depth_huber = 0;
  int64_t depth_start = 0;        ///< [ref] depth terms act after it
  int64_t depth_align_every = 0;  ///< [ref]
  double depth_align_limit = 0;   ///< largest |a_v - 1|
  double normal_consistency = 0, normal_boundary = 0, crease = 0;
  int64_t normal_start = 0;  ///< [ref] those three act after it
  double prior_normal = 0, prior_normal_end = 0;
  double plane_weight = 0;  ///< of a rendered plane beside a prior of weight 1 (plane_targets.h); 0 = none
  int64_t plane_every = 0;  ///< [ref] iterations between fits
  double multi_view_geometric = 0, multi_view_photometric = 0;
  int64_t multi_view_from = 0;   ///< [ref] those two act after it
  int64_t multi_view_every = 1;  ///< they act in every n-th iteration
  bool paper_normals = false;
  double opacity_l1 = 0, scale_l1 = 0;
};

struct SemanticConfig {
  double soft = 0, hard = 0;
  double pixel_share = 1;  ///< of the pixels, per step: 1, 0.5 or 0.25
  SemanticBlend blend = SemanticBlend::kProbabilities;
  SemanticCoupling coupling = SemanticCoupling::kBounded;
  double coupling_strength = 0;
  int64_t coupling_start = 0, coupling_stop = 0;  ///< [ref]
  bool lift = false;
  int64_t lift_at = 0;  ///< [ref] the closed-form start of the rows comes after it
  /// power of a Gaussian's smoothed probabilities where labels are drawn; 0 = rows as trained
  double drawn_sharpness = 0;
  /// and what the objects are called is decided by the photos' votes (train/photo_labels.h)
  bool object_labels = false;
  bool object_votes = false;  ///< objects by the photos' segments where there are any (train/voted_objects.h)
  int64_t active_top = 0;  ///< classes never among a teacher's so many best share one channel; 0 = every class its own
};

struct DensifyConfig {
  bool enabled = true;
  GrowthStrategy strategy = GrowthStrategy::kAdaptive;
  double noise = 0;                        ///< mcmc: strength of the noise on positions / their learning rate
  double growth = 1;                       ///< mcmc: number after a call / before
  int64_t start = 0, stop = 0, every = 0;  ///< [ref]
  double min_epochs = 0;                   ///< at least so many visits of every view between two calls
  double gradient = 0, gradient_abs = 0, small_scale = 0, prune_opacity = 0, prune_scale = 0;
  int64_t prune_scale_start = 0;  ///< [ref]
  double max_growth = 0;          ///< cap / N0; 0 = none
  int64_t max_gaussians = 0;      ///< cap; 0 = from max_growth and the memory budget
  bool morton_order = false;      ///< order rows along a Morton curve, the start's and at each call
  double residual_quantile = 0, unsupported_min = 0;
  int64_t opacity_reset_every = 0;  ///< [ref] 0 = never
  int64_t free_space_every = 0;     ///< [ref] 0 = never
  double free_space_prior = 0, free_space_offset = 0, free_space_rendered = 0, free_space_agreement = 0;
};

struct OptimizerConfig {
  double position = 0, position_end = 0;  ///< / E
  double sh_dc = 0, sh_rest = 0, opacity = 0, scale = 0, rotation = 0, semantic = 0;
  bool skip_invisible_semantics = true;
  double flat_ratio_max = 0, aspect_max = 0, scale_max = 0;  ///< hard limits after each step; scale / E
  double scale_min_pixels = 0;  ///< of the two larger scales, pixels of the sharpest training view; 0 = off
  double pose_rotation = 0, pose_translation = 0;  ///< rates of the training cameras: radians, / E; 0 = fixed
  double pose_end = 1;                             ///< share of both rates at pose_stop
  double pose_decay = 0;                  ///< share of its offset that a camera gives back at each of its steps
  int64_t pose_start = 0, pose_stop = 0;  ///< [ref]
};

struct CheckpointConfig {
  int64_t every = 0;  ///< iterations; has no influence on the result
  int64_t keep = 0;
  bool keep_finished = false;  ///< a finished run keeps what training needs to go on beyond its end
};

/// Used by `aligngs mesh`, not by training; 0 = automatic (mesh/fusion.h).
struct MeshConfig {
  FusedDepth depth = FusedDepth::kAgreeing;
  double depth_agreement = 0;     ///< agreeing: relative difference up to which plane depth is taken, not median depth
  double plane_reach = 0;         ///< |log| of depth within which walls, floor, ceiling move to their planes; 0 = off
  double smoothing = 0;           ///< pixels over which depth follows the rendered normals; 0 = off
  bool tangent_distance = false;  ///< distances from tangent planes
  double max_hole = 0;            ///< scene units
  double voxel = 0, truncation = 0, max_depth = 0;  ///< scene units
  double alpha_min = 0, min_cosine = 0;
  double consistency = 0;  ///< relative depth difference within which two views agree
  double single_view_weight = 0, contradicted_weight = 0;
  double component_area = 0, component_extent = 0;  ///< scene units; negative: keep all
  int64_t interpolated_views = 0;
};

struct TrainConfig {
  DataConfig data;
  InitConfig init;
  RunConfig train;
  LossConfig loss;
  SemanticConfig semantic;
  DensifyConfig densify;
  OptimizerConfig optimizer;
  CheckpointConfig checkpoint;
  MeshConfig mesh;
};

/// A word of kChoiceWords<Preset>; Error{kUsage} for anything else.
Preset parse_preset(const std::string& name);
TrainConfig make_preset(Preset preset);

}  // namespace aligngs
