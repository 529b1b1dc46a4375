// Cameras and prior depth of a feed-forward network, corrected from what the photos themselves say.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "refine/bundle_adjustment.h"
#include "refine/depth_grid.h"
#include "refine/pair_consensus.h"
#include "refine/resection.h"
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

/// Tracks, adjustment and what places a photo are ResectionSettings, for training and test photos alike.
struct RefineSettings : ResectionSettings {
  DepthGridSettings grid;
  int rounds = 2;                   ///< of matching and adjustment; later rounds search nearer
  PairConsensusSettings consensus;  ///< of the matches of the first round, whose search is wide
  /// BundleSettings::pixel of the adjustments before the first with coarse_pixel, as shares of the image width. Matches
  /// that are far off at first are no outliers then (graduated non-convexity, Blake and Zisserman 1987).
  std::vector<double> graduated{0.025, 0.00625};
  double lost_search = 0.15;  ///< of the image width: for photos of which the usual search finds too little
  /// of the median photo's share of matches that agree with the cameras: a training photo below is lost
  double lost_share = 0.45;
  /// the same in the first round: pairs have lost most wrong matches before, so that the others agree
  double first_lost_share = 0.7;
  /// of the median photo's way from its prior place, and at least BundleSettings::centre. A training photo that goes
  /// farther is looked for like a lost one, and goes where most matches agree.
  double stray_factor = 4;
  bool share_focal = true;  ///< all photos come from one lens: their focal lengths become the median first
};

/// Outcome of a view.
struct RefinedView {
  Camera camera;
  DepthGrid depth;            ///< correction of its prior depth; none for test views
  int observations = 0;       ///< that fit
  double turned = 0;          ///< degrees from the prior
  double shifted = 0;         ///< of the centre from the prior, scene units
  bool by_neighbour = false;  ///< too few observations: follows its nearest neighbour
  /// a training view whose matches did not fit where the prior has it; found elsewhere by the others' points
  bool misplaced = false;
};

/// Fills in how far the camera of `view` is from `prior`.
void measure_change(const Camera& prior, RefinedView& view);

struct RefineResult {
  std::vector<RefinedView> views;
  PointCloud points;        ///< tracks of at least three photos, coloured
  BundleReport bundle;      ///< start: the cameras of the input; end: of the last round
  double focal_factor = 1;  ///< of the last adjustment
  size_t tracks = 0;
};

using RefineProgress = std::function<void(double share)>;

/// Matches, adjusts, registers test views, corrects depths. `extent` in scene units. Deterministic for any number of
/// threads. Views that see nothing of each other keep their cameras.
RefineResult refine_cameras(const std::vector<RefineView>& views, double extent, const RefineSettings& settings,
                            ThreadPool& pool, const RefineProgress& progress = {});

}  // namespace aligngs
