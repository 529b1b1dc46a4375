#include "train/config_keys.h"

namespace aligngs::config_table {

std::vector<ConfigKey> checkpoint_mesh_keys() {
  using C = TrainConfig;
  using M = MeshConfig;
  return {
      {"checkpoint.every", field<&C::checkpoint, &CheckpointConfig::every>, 1, kIterationsMax, value(500),
       "iterations between checkpoints; none in the last quarter of that before the end; does not change the result"},
      {"checkpoint.keep", field<&C::checkpoint, &CheckpointConfig::keep>, 1, 1000, value(2),
       "checkpoints kept, newest first"},
      {"checkpoint.keep_finished", field<&C::checkpoint, &CheckpointConfig::keep_finished>, 0, 0, value(false),
       "a finished run keeps the state of its optimiser, so that a larger -n can go on"},

      {"mesh.depth", field<&C::mesh, &M::depth>, 0, 0, value(FusedDepth::kAgreeing),
       "rendered depth to fuse; agreeing: plane depth where it agrees with the median depth, else the median "
       "depth"},
      {"mesh.depth_agreement", field<&C::mesh, &M::depth_agreement>, 0, 1, value(0.01),
       "relative difference up to which plane depth agrees with median depth"},
      {"mesh.prior_agreement", field<&C::mesh, &M::prior_agreement>, 0, 0.5, value(0.02),
       "relative difference up to which prior depth is fused where rendered depth confirms it, and none from twice "
       "that on; for depth that is measured by a sensor or in the photos, or refined; 0 = off"},
      {"mesh.plane_reach", field<&C::mesh, &M::plane_reach>, 0, 0.5, value(0.03),
       "relative distance up to which labelled walls, floor and ceiling move to their planes; 0 = off"},
      {"mesh.smoothing", field<&C::mesh, &M::smoothing>, 0, 100, value(3.0),
       "pixels over which depth follows the rendered normals; 0 = off"},
      {"mesh.tangent_distance", field<&C::mesh, &M::tangent_distance>, 0, 0, value(true),
       "fuse distances from tangent planes instead of distances along rays"},
      {"mesh.face_filter", field<&C::mesh, &M::face_filter>, 0, 100, value(10),
       "rounds of a filter over the normals of faces, which takes noise and keeps edges; 0 = off"},
      {"mesh.voxel", field<&C::mesh, &M::voxel>, 0, kAny, value(0.0),
       "edge of a voxel, scene units; 0: 1.5 pixel footprints at the median depth, 0.5 to 1.5 cm when metric"},
      {"mesh.truncation", field<&C::mesh, &M::truncation>, 0, kAny, value(0.0),
       "truncation distance, scene units; 0: from the voxel and the depth residual"},
      {"mesh.max_depth", field<&C::mesh, &M::max_depth>, 0, kAny, value(0.0),
       "depth beyond which nothing is fused, scene units; 0: 1.5 times the 95th percentile"},
      {"mesh.alpha_min", field<&C::mesh, &M::alpha_min>, 0, 1, value(0.7),
       "accumulated opacity below which a pixel is not fused"},
      {"mesh.min_cosine", field<&C::mesh, &M::min_cosine>, 0, 1, value(0.1),
       "cosine of the viewing angle below which a pixel is not fused"},
      {"mesh.consistency", field<&C::mesh, &M::consistency>, 0, 1, value(0.01),
       "relative depth difference within which two views agree"},
      {"mesh.single_view_weight", field<&C::mesh, &M::single_view_weight>, 0, 1, value(0.25),
       "weight of surface that one view alone sees"},
      {"mesh.contradicted_weight", field<&C::mesh, &M::contradicted_weight>, 0, 1, value(0.0),
       "weight of surface that another view looks through"},
      {"mesh.component_area", field<&C::mesh, &M::component_area>, -1, kAny, value(0.0),
       "components of less area are removed, squared scene units; 0: 25 cm^2; negative: none"},
      {"mesh.component_extent", field<&C::mesh, &M::component_extent>, -1, kAny, value(0.0),
       "components of less extent are removed, scene units; 0: 10 cm; negative: none"},
      {"mesh.max_hole", field<&C::mesh, &M::max_hole>, 0, kAny, value(0.0),
       "holes up to this size are closed where views have seen surface and none looks through, scene units; 0 = none"},
      {"mesh.interpolated_views", field<&C::mesh, &M::interpolated_views>, 0, 10000, value(0),
       "views rendered between training views that are fused too; they never create or carve surface"},
  };
}

}  // namespace aligngs::config_table
