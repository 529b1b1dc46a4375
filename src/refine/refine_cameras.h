// Cameras and prior depth of a feed-forward network, corrected from what the photos themselves say.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "refine/bundle_adjustment.h"
#include "refine/depth_grid.h"
#include "refine/tracks.h"
#include "scene/point_cloud.h"

namespace aligngs {

/// One photo.
struct RefineView {
  std::string name;
  MatchView match;    ///< camera, luma and prior depth; a test view's depth is not used and may be empty
  ImageF color;       ///< H x W x 3, for the colours of the points
  ImageF mask;        ///< 0 = do not use this pixel; may be empty
  bool test = false;  ///< registered afterwards against the points of the training views, which it does not move
};

struct RefineSettings {
  TrackSettings tracks;
  BundleSettings bundle;
  DepthGridSettings grid;
  int rounds = 2;               ///< of matching and adjustment; later rounds search nearer
  double lost_search = 0.15;    ///< of the image width: for test photos of which the usual search finds too little
  double coarse_pixel = 0.5;    ///< pixels: `bundle.pixel` of the very first adjustment and of each search for test views, which start too far off for the exact one
  double outlier = 3;           ///< pixels: observations beyond are dropped before and after the exact adjustment
  int least_observations = 15;  ///< a view with fewer keeps its prior relative to its nearest neighbour
  double least_fitting = 0.5;   ///< share of a test view's matches that agree with the pose found for it; with fewer it is not placed
  bool share_focal = true;      ///< all photos come from one lens: their focal lengths become the median first
};

/// What became of a view.
struct RefinedView {
  Camera camera;
  DepthGrid depth;         ///< correction of its prior depth; none for test views
  int observations = 0;    ///< that fit
  double turned = 0;       ///< degrees from the prior
  double shifted = 0;      ///< of the centre from the prior, scene units
  bool by_neighbour = false;  ///< too few observations: follows its nearest neighbour
};

/// Fills in how far the camera of `view` is from `prior`.
void measure_change(const Camera& prior, RefinedView& view);

struct RefineResult {
  std::vector<RefinedView> views;
  PointCloud points;       ///< tracks of at least three photos, coloured
  BundleReport bundle;     ///< start: the cameras as they came; end: of the last round
  double focal_factor = 1; ///< of the last adjustment
  size_t tracks = 0;
};

using RefineProgress = std::function<void(double share)>;

/// Matches, adjusts, registers test views, corrects depths. `extent` in scene units. Deterministic for any number of
/// threads. Views that see nothing of each other keep their cameras. Error{kFailed} without Ceres.
RefineResult refine_cameras(const std::vector<RefineView>& views, double extent, const RefineSettings& settings,
                            ThreadPool& pool, const RefineProgress& progress = {});

}  // namespace aligngs
