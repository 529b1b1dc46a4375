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

/// Measures and writes metrics.json (unless another mesh was given). Parts without truth stay empty, never a substitute.
RunMetrics evaluate_run(LoadedRun& run, const EvalStageOptions& options);

/// A condition of --fail-under.
struct LeastValue {
  std::string path;  ///< "nvs.psnr"
  double least = 0;  ///< in the figure's unit
};
/// Reads conditions such as "psnr=24" or "geometry.fscore=0.5"; call before long work. Error{kUsage} when one cannot be
/// read, is not finite or names no part of metrics.json. Short names: psnr, ssim, fscore, miou.
std::vector<LeastValue> least_values(const std::vector<std::string>& conditions);

/// Error{kBelow} (status 6) when a figure is lower, Error{kUsage} when the metrics do not have it.
void require_at_least(const RunMetrics& metrics, const std::vector<LeastValue>& values);

}  // namespace aligngs
