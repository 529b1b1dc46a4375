// The presets: each says what it changes of another one. The table of the keys (config_table_*.cpp) has `default`.
#include "scene/view_data.h"
#include "train/config_keys.h"

namespace aligngs::config_table {

/// A first look in about a minute.
PresetChanges preview_changes() {
  return {Preset::kDefault,
          {
              {"data.scale", value(0.5)},
              {"init.voxel_footprints", value(1.5)},
              {"init.gaussians_per_pixel", value(0.8)},
              {"train.preset", value(Preset::kPreview)},
              {"train.iterations", value(1000)},
              {"densify.gradient_abs", value(0.0)},
              {"densify.small_scale", value(0.01)},
              {"densify.max_growth", value(1.5)},
              {"densify.residual_quantile", value(0.9)},
              {"densify.unsupported_min", value(0.5)},
          }};
}

/// AlignGS as printed (Gao et al. 2025).
PresetChanges paper_changes() {
  return {Preset::kDefault,
          {
              {"data.measure_depth", value(false)},
              {"data.bare_planes", value(false)},
              {"data.refine_cameras", value(false)},
              {"data.refine_stereo", value(false)},
              {"data.refine_planes", value(false)},
              {"data.refine_square", value(false)},
              {"data.refine_panels", value(false)},
              {"data.refine_screens", value(false)},
              {"data.refine_exposure", value(false)},
              {"data.sensor_exposure", value(false)},
              {"data.sensor_cameras", value(false)},
              {"data.exposure", value(false)},
              {"data.ignore", value("")},
              {"data.scores_as_logits", value(true)},
              {"data.least_score_sum", value(kUnknownScoreSum)},
              {"init.start", value(StartSource::kCloud)},
              {"init.cloud_flat_ratio", value(1.0)},
              {"init.voxel_footprints", value(1.5)},
              {"init.scale_max", value(0.0)},
              {"init.max_gaussians", value(100000)},
              {"init.gaussians_per_pixel", value(0.0)},
              {"train.preset", value(Preset::kPaper)},
              {"train.iterations", value(7000)},
              {"train.sh_degree", value(3)},
              {"train.near_share", value(0.0)},
              {"train.opacity_dropout", value(0.0)},
              {"train.random_background", value(false)},
              {"loss.flatten", value(100.0)},
              {"loss.log_depth", value(0.0)},
              {"loss.log_depth_end", value(0.0)},
              {"loss.depth_start", value(1500)},
              {"loss.depth_align_every", value(0)},
              {"loss.normal_consistency", value(0.05)},
              {"loss.normal_boundary", value(0.01)},
              {"loss.normal_start", value(1500)},
              {"loss.prior_normal", value(0.0)},
              {"loss.prior_normal_end", value(0.0)},
              {"loss.paper_normals", value(true)},
              {"loss.opacity_l1", value(0.0)},
              {"loss.scale_l1", value(0.0)},
              {"semantic.pixel_share", value(1.0)},
              {"semantic.blend", value(SemanticBlend::kLogits)},
              {"semantic.coupling", value(SemanticCoupling::kPlain)},
              {"semantic.coupling_strength", value(1.0)},
              {"semantic.coupling_start", value(0)},
              {"semantic.coupling_stop", value(7000)},
              {"semantic.lift", value(false)},
              {"semantic.drawn_sharpness", value(0.0)},
              {"semantic.object_labels", value(false)},
              {"semantic.object_votes", value(false)},
              {"semantic.active_top", value(0)},
              {"densify.start", value(500)},
              {"densify.stop", value(7000)},
              {"densify.min_epochs", value(1.0)},
              {"densify.prune_scale", value(0.1)},
              {"densify.max_growth", value(0.0)},
              {"densify.opacity_reset_every", value(3000)},
              {"densify.free_space_every", value(0)},
              {"optimizer.rotation", value(1e-3)},
              {"optimizer.semantic", value(1e-3)},
              {"optimizer.skip_invisible_semantics", value(false)},
              {"optimizer.flat_ratio_max", value(0.0)},
              {"optimizer.aspect_max", value(0.0)},
              {"optimizer.scale_min_pixels", value(0.0)},
              {"mesh.depth", value(FusedDepth::kPlane)},
              {"mesh.prior_agreement", value(0.0)},
              {"mesh.plane_reach", value(0.0)},
              {"mesh.smoothing", value(0.0)},
              {"mesh.tangent_distance", value(false)},
              {"mesh.face_filter", value(0)},
              {"mesh.alpha_min", value(0.5)},
              {"mesh.min_cosine", value(0.0)},
              {"mesh.single_view_weight", value(1.0)},
              {"mesh.contradicted_weight", value(1.0)},
          }};
}

/// More Gaussians and steps.
PresetChanges high_changes() {
  return {Preset::kDefault,
          {
              {"init.voxel_footprints", value(1.0)},
              {"init.max_gaussians", value(400000)},
              {"init.gaussians_per_pixel", value(1.6)},
              {"train.preset", value(Preset::kHigh)},
              {"train.iterations", value(4000)},
          }};
}

/// PGSR (Chen et al. 2024): photos alone, with the terms between views. It builds on the paper.
PresetChanges pgsr_changes() {
  return {Preset::kPaper,
          {
              {"data.prior_depth", value(PriorDepthUse::kNone)},
              {"data.semantics", value(false)},
              {"train.preset", value(Preset::kPgsr)},
              {"loss.pearson", value(0.0)},
              {"loss.normal_consistency", value(0.015)},
              {"loss.normal_boundary", value(0.0)},
              {"loss.normal_start", value(1633)},
              {"loss.multi_view_geometric", value(0.03)},
              {"loss.multi_view_photometric", value(0.15)},
              {"loss.paper_normals", value(false)},
          }};
}

}  // namespace aligngs::config_table
