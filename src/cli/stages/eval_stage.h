// metrics.json of a run: novel views, geometry, semantics, what the training cost.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/stages/loaded_run.h"
#include "core/progress.h"
#include "metrics/run_metrics.h"

namespace aligngs {

struct EvalStageOptions {
  std::filesystem::path truth_mesh;  ///< empty: truth/mesh.ply of the scene
  std::filesystem::path mesh;        ///< empty: mesh/mesh.ply of the run; otherwise metrics.json is not written
  bool refine_test_poses = true;     ///< adds nvs.pose_refined: the scores once each test photo's pose is fitted to it
  bool views = true;                 ///< false: the mesh alone, with `mesh`; what views say is null
  bool icp = false;                  ///< adds the ICP-aligned variants (a diagnostic)
  ProgressStyle progress;
};

/// Error{kBadInput} that names the option unless meshes that were named are there: before minutes of measuring.
void require_named_meshes(const EvalStageOptions& options);

/// Measures and writes metrics.json (unless another mesh was given). Parts without truth stay empty, never a substitute.
/// Errors as require_named_meshes', and for a named mesh without triangles; metrics.json stays as it was then.
RunMetrics evaluate_run(LoadedRun& run, const EvalStageOptions& options);

}  // namespace aligngs
