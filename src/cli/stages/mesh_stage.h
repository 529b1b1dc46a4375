// The mesh of a run: rendered (or prior) depth of the training views, fused, extracted, cleaned, labelled.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "cli/stages/loaded_run.h"
#include "mesh/fusion.h"
#include "mesh/mesh_labels.h"
#include "mesh/tsdf_device.h"

namespace aligngs {

/// Depth that is fused over the training views.
enum class DepthSource {
  kRendered,  ///< depth of the Gaussians
  kPrior,     ///< pred_depths/ with the run's cameras: the yardstick that a method must beat to have added anything
  kTruth      ///< truth/depth with the true cameras: the ceiling of what these views can show
};

/// Makes the device to fuse on when the views are there; empty: the CPU.
using TsdfDeviceFactory = std::function<std::shared_ptr<TsdfDevice>()>;

struct MeshStageOptions {
  DepthSource source = DepthSource::kRendered;
  std::filesystem::path output;  ///< empty: mesh/mesh.ply of the run
  /// folder for pictures of the mesh from pictured_views(); empty: renders/SPLIT/surface for the run's mesh
  std::filesystem::path pictures;
  TsdfDeviceFactory make_device = {};
  bool may_be_empty = false;  ///< no surface is no error: nothing is written, and a mesh of an earlier time is removed
  bool keep_looks = false;    ///< fills LoadedRun::looks from the rendered views: 10 bytes a pixel
};

struct MeshStageResult {
  std::filesystem::path file;  ///< empty: no surface came out
  FusionReport fusion;
  MeshLabelingReport labels;
};

/// Settings come from the run's config.toml (group mesh). Error{kFailed} when no surface came out, unless may_be_empty.
MeshStageResult mesh_run(LoadedRun& run, const MeshStageOptions& options);

}  // namespace aligngs
