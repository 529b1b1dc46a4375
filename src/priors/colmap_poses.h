// Cameras and points of photos by the COLMAP program, with settings for few photos of a room.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/thread_pool.h"
#include "io/colmap.h"
#include "priors/colmap_database.h"
#include "priors/photo_folder.h"
#include "scene/point_cloud.h"

namespace aligngs {

struct ColmapPosesOptions {
  bool shared_camera = true;  ///< photos of one size come from one camera
  int threads = 0;            ///< of the program; 0: all
  ProgressStyle progress;
};

struct ColmapPoses {
  ColmapModel model;              ///< the largest one; no images when there is none
  std::vector<LeftOut> unplaced;  ///< photos that have no camera, and why
  int other_models = 0;           ///< smaller ones, not connected with it
  double reprojection_error = 0;  ///< mean over its points, pixels
  std::string second_failure;     ///< why the second attempt ended early; empty: it did not
};

/// Pixels of the shorter side. Feature extraction for affine shapes aborts below them.
inline constexpr int kLeastColmapSide = 16;

/// Error{kFailed} where the program is not in PATH.
void require_colmap();

/// Photos lie in `work`/images (prepare_photos), and none is narrower than kLeastColmapSide. Everything else that
/// COLMAP makes goes to `work`, its messages to `work`/colmap.log. A second attempt with slower, more sensitive features follows
/// when not all photos could be placed; the better one counts. A second attempt that fails leaves the first one,
/// and `second_failure` says why. Error{kFailed} when the program is missing or fails without a camera.
ColmapPoses find_poses_with_colmap(const std::vector<Photo>& photos, const std::filesystem::path& work,
                                   const ColmapPosesOptions& options);

/// The points whose reprojection error is small enough to start from.
PointCloud reliable_points(const ColmapModel& model);

/// Why a photo is not in the model, from what was found in it and shared with others.
std::string why_unplaced(const ColmapDatabase& database, const std::string& photo,
                         const std::vector<std::string>& placed);

}  // namespace aligngs
