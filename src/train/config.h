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
  double scale{};  ///< working resolution / image resolution
  PriorDepthUse prior_depth{};
  bool measure_depth{};        ///< `run`: depth by multi-view stereo where the scene has points and no prior depth
  bool bare_planes{};          ///< bare surfaces lie on planes of what was measured
  bool refine_cameras{};       ///< `run` and `demo`: correct cameras and prior depth before training
  bool refine_stereo{};        ///< and the depth by multi-view stereo
  bool refine_planes{};        ///< and by the planes of walls, floor and ceiling
  bool refine_tables{};        ///< and of tables, desks and counters
  bool refine_fused_labels{};  ///< which are found by the labels of most photos
  bool refine_square{};        ///< and turned to the axes of the room
  bool refine_panels{};        ///< and panes, mirrors, screens and pictures by planes of their own
  bool refine_screens{};       ///< of those, televisions and monitors by their outlines in several photos
  bool prior_confidence{};     ///< weigh prior depth by pred_confidence/ where there is one
  std::string ignore;          ///< classes whose pixels are left out, with commas (scene/ignored_classes.h)
  bool semantics{};            ///< use segmentation_logits/ when every training view has them
  bool sensor_exposure{};      ///< `run`: measure exposures from depth of a sensor, or given depth
  bool sensor_cameras{};       ///< `run`: correct the cameras that come with depth of a sensor
  bool clean_depth{};          ///< and leave out pixels of that depth that mix two surfaces
  bool fill_depth{};           ///< and fill holes of that depth by stereo
  bool refine_exposure{};      ///< `run` and `demo`: measure the photos' exposures there
  bool exposure{};             ///< undo what exposure.json says of the photos' exposures
  bool scores_as_logits{};     ///< softmax the teacher's numbers whatever priors.json calls them
  double score_gamma{};        ///< exponent of the calibration of score teachers
  double least_score_sum{};    ///< of a pixel, below which it says nothing
};

struct InitConfig {
  StartSource start{};
  double depth_opacity{}, depth_flat_ratio{};  ///< of a start from prior depth
  double single_view_opacity{};                ///< of prior depth that only one view confirms
  double cloud_opacity{}, cloud_flat_ratio{};  ///< of a start from the point cloud (flat only with normals)
  double voxel_footprints{};                   ///< edge of the thinning cubes in pixel footprints at the median depth
  double scale_max{};                          ///< largest initial scale / E; 0 = none
  int64_t max_gaussians{};                     ///< N0 is thinned to this many
  double gaussians_per_pixel{};  ///< and to this many per pixel of the largest training view; 0 = no such limit
  bool far_shell{};              ///< and of a sensor's: points behind the room where it measured nothing
  int64_t random_count{};        ///< points of a random start
};

struct RunConfig {
  Preset preset{};  ///< that these settings began as
  int64_t iterations{};
  int64_t reference_iterations{};  ///< the run length in which [ref] keys are counted
  int64_t schedule_iterations{};   ///< length of the schedules; 0 = iterations. Pinned when a run is extended.
  int64_t seed{};
  /// highest degree; -1: by the number of training views and who made the cameras (Schedule::request)
  int64_t sh_degree{};
  int64_t sh_every{};              ///< [ref] one degree more after so many
  double coarse_scale{};           ///< resolution of the first steps / working resolution; 1 = all steps are alike
  int64_t coarse_stop{};           ///< [ref] steps at that resolution
  double near_plane{};             ///< / E
  double opacity_dropout{};        ///< share of the Gaussians left out of a step at the end of the schedule
  int64_t opacity_dropout_stop{};  ///< [ref] the last step that leaves any out
  bool closed_room{};              ///< finish with the unseen parts of walls, floor and ceiling
  bool random_background{};        ///< a new colour behind the scene every step; false: black
  double near_share{};             ///< / smallest metric prior depth of the view; 0 = off
  int64_t log_every{};             ///< iterations between lines of events.ndjson
};

struct LossConfig {
  double l1{}, ssim{}, flatten{};
  double pearson{}, log_depth{}, log_depth_end{}, log_depth_huber{};
  int64_t depth_start{};        ///< [ref] depth terms act after it
  int64_t depth_align_every{};  ///< [ref]
  double depth_align_limit{};   ///< largest |a_v - 1|
  double normal_consistency{}, normal_boundary{}, crease{};
  int64_t normal_start{};  ///< [ref] those three act after it
  double prior_normal{}, prior_normal_end{};
  double plane_weight{};  ///< of a rendered plane beside a prior of weight 1 (plane_targets.h); 0 = none
  int64_t plane_every{};  ///< [ref] iterations between fits
  double multi_view_geometric{}, multi_view_photometric{};
  int64_t multi_view_from{};   ///< [ref] those two act after it
  int64_t multi_view_every{};  ///< they act in every n-th iteration
  bool paper_normals{};
  double opacity_l1{}, scale_l1{};
};

struct SemanticConfig {
  double soft{}, hard{};
  double pixel_share{};  ///< of the pixels, per step: 1, 0.5 or 0.25
  SemanticBlend blend{};
  SemanticCoupling coupling{};
  double coupling_strength{};
  int64_t coupling_start{}, coupling_stop{};  ///< [ref]
  bool lift{};
  int64_t lift_at{};  ///< [ref] the closed-form start of the rows comes after it
  /// power of a Gaussian's smoothed probabilities where labels are drawn; 0 = rows as trained
  double drawn_sharpness{};
  /// and what the objects are called is decided by the photos' votes (train/photo_labels.h)
  bool object_labels{};
  bool object_votes{};   ///< objects by the photos' segments where there are any (train/voted_objects.h)
  int64_t active_top{};  ///< classes never among a teacher's so many best share one channel; 0 = every class its own
};

struct DensifyConfig {
  bool enabled{};
  GrowthStrategy strategy{};
  double noise{};                    ///< mcmc: strength of the noise on positions / their learning rate
  double growth{};                   ///< mcmc: number after a call / before
  int64_t start{}, stop{}, every{};  ///< [ref]
  double min_epochs{};               ///< at least so many visits of every view between two calls
  double gradient{}, gradient_abs{}, small_scale{}, prune_opacity{}, prune_scale{};
  int64_t prune_scale_start{};  ///< [ref]
  double max_growth{};          ///< cap / N0; 0 = none
  int64_t max_gaussians{};      ///< cap; 0 = from max_growth and the memory budget
  bool morton_order{};          ///< order rows along a Morton curve, the start's and at each call
  double residual_quantile{}, unsupported_min{};
  int64_t opacity_reset_every{};  ///< [ref] 0 = never
  int64_t free_space_every{};     ///< [ref] 0 = never
  double free_space_prior{}, free_space_offset{}, free_space_rendered{}, free_space_agreement{};
};

struct OptimizerConfig {
  double position{}, position_end{};  ///< / E
  double sh_dc{}, sh_rest{}, opacity{}, scale{}, rotation{}, semantic{};
  bool skip_invisible_semantics{};
  double flat_ratio_max{}, aspect_max{}, scale_max{};  ///< hard limits after each step; scale / E
  double scale_min_pixels{};  ///< of the two larger scales, pixels of the sharpest training view; 0 = off
  double pose_rotation{}, pose_translation{};  ///< rates of the training cameras: radians, / E; 0 = fixed
  double pose_end{};                           ///< share of both rates at pose_stop
  double pose_decay{};                         ///< share of its offset that a camera gives back at each of its steps
  int64_t pose_start{}, pose_stop{};           ///< [ref]
};

struct CheckpointConfig {
  int64_t every{};  ///< iterations; has no influence on the result
  int64_t keep{};
  bool keep_finished{};  ///< a finished run keeps what training needs to go on beyond its end
};

/// Used by `aligngs mesh`, not by training; 0 = automatic (mesh/fusion.h).
struct MeshConfig {
  FusedDepth depth{};
  double depth_agreement{};  ///< agreeing: relative difference up to which plane depth is taken, not median depth
  double prior_agreement{};  ///< relative difference up to which prior depth is fused, not rendered depth; 0 = off
  double plane_reach{};      ///< |log| of depth within which walls, floor, ceiling move to their planes; 0 = off
  double smoothing{};        ///< pixels over which depth follows the rendered normals; 0 = off
  bool tangent_distance{};   ///< distances from tangent planes
  int64_t face_filter{};     ///< rounds of the filter over the normals of faces; 0 = off
  double max_hole{};         ///< scene units
  double voxel{}, truncation{}, max_depth{};  ///< scene units
  double alpha_min{}, min_cosine{};
  double consistency{};  ///< relative depth difference within which two views agree
  double single_view_weight{}, contradicted_weight{};
  double component_area{}, component_extent{};  ///< scene units; negative: keep all
  int64_t interpolated_views{};
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
