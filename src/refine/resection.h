// Pose of a photo, from the points of other photos' tracks, which it does not move.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "refine/bundle_adjustment.h"
#include "refine/pose_ransac.h"
#include "refine/tracks.h"

namespace aligngs {

struct ResectionSettings {
  TrackSettings tracks;
  BundleSettings bundle;
  PoseSearchSettings poses;
  /// pixels: BundleSettings::pixel of the first adjustment, which starts too far off for the exact one
  double coarse_pixel = 0.5;
  double outlier = 3;           ///< pixels: matches beyond do not agree with the pose
  int least_observations = 15;  ///< a photo with fewer is not placed
  /// share of a photo's matches that agree with the pose found for it; with fewer it is not placed
  double least_fitting = 0.5;
  /// Share of the points in front of its pose, hidden ones included, that a photo is found to show. Rooms have 0.08 to
  /// 0.95 at right poses. The same pattern elsewhere has 0.02 to 0.03.
  double least_shown = 0.05;
};

/// A photo to be placed; its camera is where the search begins and, once it is placed, the result.
struct WantedPhoto {
  int view = 0;                ///< its number; none of the tracks begins in it
  MatchView* match = nullptr;  ///< depth is not read
  const ImageF* mask = nullptr;
  int observations = 0;  ///< out: that agree with the camera found; 0 = not placed, the camera is as it was
};

/// The points that others may be placed by.
struct PlacedScene {
  const std::vector<Track>& tracks;
  const std::vector<TrackPhoto>& photos;  ///< in which they begin
  double extent = 1;                      ///< scene units
};

/// How a photo is looked for.
struct PhotoSearch {
  double reach = 0.05;  ///< of the image width: how far points may lie from where its camera expects them
  /// begins with the pose of most matches (`ransac_pose`); otherwise with the camera, which must be about right
  bool by_most = false;
};

/// Searches, and searches again near the place found, which finds more. A photo is placed when enough matches agree
/// with one pose. If it begins with its camera, and always in the second search, most matches must agree. They must
/// also be enough of the points that it would see from there: wrong ones agree with some pose, too. Deterministic for
/// any number of threads.
void place_photos(const PlacedScene& scene, std::vector<WantedPhoto>& wanted, const PhotoSearch& search,
                  const ResectionSettings& settings, ThreadPool& pool);

}  // namespace aligngs
