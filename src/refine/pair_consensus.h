// Matches of a pair of photos that agree with one pose, where cameras are far from right and many matches are wrong.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "refine/pose_ransac.h"
#include "refine/tracks.h"

namespace aligngs {

struct PairConsensusSettings {
  int samples = 200;  ///< of three matches each; where a third of a pair's matches is right, seven samples are
  /// share of the image width between a match and its point in the pair's pose: bent depth moves it so far
  double agreement = 0.0125;
  /// matches of a pair that are enough to judge it; a pair with fewer can be all that holds two groups of photos
  int judged = 20;
  int least = 8;             ///< matches that agree; a pair with fewer tells nothing
  double least_share = 0.2;  ///< of a pair's matches that agree; with less, they agree by chance
  double largest_turn = 15;  ///< degrees between the pair's pose and the camera
};

/// Leaves each pair of photos with many matches those that agree with the pose of most of them (`ransac_pose`). Leaves
/// none where these are too few. The points are those of the tracks, as prior depth of the photo where they begin has
/// them. Cameras are read, not moved. Drops tracks that no other photo shows any more. The same for any number of
/// threads.
void keep_agreeing_matches(std::vector<Track>& tracks, const std::vector<TrackPhoto>& photos,
                           const PairConsensusSettings& settings, ThreadPool& pool);

}  // namespace aligngs
