#include "train/config_keys.h"

namespace aligngs::config_table {

std::vector<ConfigKey> data_init_train_keys() {
  using C = TrainConfig;
  return {
      {"data.scale", field<&C::data, &DataConfig::scale>, 0.05, 1, "", each(0.5, 1.0, 1.0, 1.0),
       "working resolution / image resolution"},
      {"data.prior_depth", field<&C::data, &DataConfig::prior_depth>, 0, 0, "auto|metric|relative|none", all("auto"),
       "what pred_depths/ hold: depth of one scale in all views (metric), monocular depth (relative); auto: by priors.json"},
      {"data.prior_confidence", field<&C::data, &DataConfig::prior_confidence>, 0, 0, "", all(true),
       "weigh prior depth by pred_confidence/<view>.npy where there is one"},
      {"data.semantics", field<&C::data, &DataConfig::semantics>, 0, 0, "", all(true),
       "use segmentation_logits/ when every training view has them"},
      {"data.scores_as_logits", field<&C::data, &DataConfig::scores_as_logits>, 0, 0, "", ours_paper(false, true),
       "softmax the teacher's numbers whatever priors.json calls them (the paper's reading)"},
      {"data.score_gamma", field<&C::data, &DataConfig::score_gamma>, 0.1, 10, "", all(1.0),
       "exponent of the calibration of score teachers, max(s, 0)^gamma / sum"},

      {"init.start", field<&C::init, &InitConfig::start>, 0, 0, "auto|depth|cloud|random", ours_paper("auto", "cloud"),
       "where Gaussians start: fused prior depth, sparse/points3D, random points; auto: depth when it is metric, else cloud"},
      {"init.depth_opacity", field<&C::init, &InitConfig::depth_opacity>, 0.01, 0.99, "", all(0.5),
       "initial opacity of a start from prior depth"},
      {"init.depth_flat_ratio", field<&C::init, &InitConfig::depth_flat_ratio>, 0.01, 1, "", all(0.1),
       "smallest / other initial scales of a start from prior depth"},
      {"init.single_view_opacity", field<&C::init, &InitConfig::single_view_opacity>, 0, 0.99, "", all(0.2),
       "initial opacity where only one view gives prior depth; 0 leaves those points out"},
      {"init.cloud_opacity", field<&C::init, &InitConfig::cloud_opacity>, 0.01, 0.99, "", all(0.1),
       "initial opacity of a start from the cloud or from random points"},
      {"init.cloud_flat_ratio", field<&C::init, &InitConfig::cloud_flat_ratio>, 0.01, 1, "", ours_paper(0.1, 1.0),
       "smallest / other initial scales of a cloud with normals; without normals the start is isotropic"},
      {"init.voxel_footprints", field<&C::init, &InitConfig::voxel_footprints>, 0.1, 100, "", all(1.5),
       "edge of the thinning cubes of the depth start, in pixel footprints at the median depth"},
      {"init.scale_max", field<&C::init, &InitConfig::scale_max>, 0, kAny, "", ours_paper(0.05, 0.0),
       "largest initial scale / extent; 0 = none"},
      {"init.max_gaussians", field<&C::init, &InitConfig::max_gaussians>, 1, 1e8, "", each(250000, 250000, 100000, 400000),
       "the start is thinned to this many Gaussians"},
      {"init.gaussians_per_pixel", field<&C::init, &InitConfig::gaussians_per_pixel>, 0, 1000, "", each(0.8, 0.8, 0.0, 1.3),
       "and to this many per pixel of the largest training view; 0 = no such limit"},
      {"init.random_count", field<&C::init, &InitConfig::random_count>, 1, 1e8, "", all(100000),
       "points of a random start"},

      {"train.preset", field<&C::train, &RunConfig::preset>, 0, 0, "preview|default|paper|high",
       each("preview", "default", "paper", "high"), "the preset these settings began as"},
      {"train.iterations", field<&C::train, &RunConfig::iterations>, 1, kIterationsMax, "", each(1000, 7000, 7000, 15000),
       "training steps, one view each"},
      {"train.reference_iterations", field<&C::train, &RunConfig::reference_iterations>, 1, kIterationsMax, "", all(7000),
       "run length in which all keys marked [ref] are counted; they scale with the schedule's length"},
      {"train.schedule_iterations", field<&C::train, &RunConfig::schedule_iterations>, 0, kIterationsMax, "", all(0),
       "length of all schedules; 0 = train.iterations; pinned to the old end when a run is extended"},
      {"train.seed", field<&C::train, &RunConfig::seed>, 0, 9007199254740992.0, "", all(0), "seed of every random choice"},
      {"train.sh_degree", field<&C::train, &RunConfig::sh_degree>, -1, 3, "", ours_paper(-1, 3),
       "highest degree of the spherical harmonics; -1: 1, and 2 above 30 training views"},
      {"train.sh_every", field<&C::train, &RunConfig::sh_every>, 1, kIterationsMax, "", all(1000),
       "[ref] iterations after which one more degree is used"},
      {"train.near_plane", field<&C::train, &RunConfig::near_plane>, 1e-6, 1, "", all(0.02),
       "camera depth / extent below which a Gaussian is not drawn"},
      {"train.near_share", field<&C::train, &RunConfig::near_share>, 0, 1, "", ours_paper(0.5, 0.0),
       "in a training view also below this share of its nearest metric prior depth (1 % quantile); 0 = off"},
      {"train.random_background", field<&C::train, &RunConfig::random_background>, 0, 0, "", ours_paper(true, false),
       "another colour behind the scene every step, so that black surfaces are not explained by holes"},
      {"train.log_every", field<&C::train, &RunConfig::log_every>, 1, kIterationsMax, "", all(10),
       "iterations between lines of events.ndjson"},
  };
}

}  // namespace aligngs::config_table
