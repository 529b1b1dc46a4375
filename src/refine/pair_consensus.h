// Matches of a pair of photos that agree with one pose, where cameras are far from right and many matches are wrong.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "refine/pose_ransac.h"
#include "refine/tracks.h"

namespace aligngs {

struct PairConsensusSettings {
  /// Of three matches each. A third of a pair's matches is right where photos are hard: seven samples in 200 are.
  int samples = 200;
  /// of the image width between a match and where the pair's pose has its point: bent prior depth and a wrong focal
  /// length move it so far, and wrong matches of a repeated pattern lie farther apart
  double agreement = 0.0125;
  int least = 8;             ///< matches that agree; a pair with fewer tells nothing
  double least_share = 0.2;  ///< of a pair's matches that agree; with less, they agree by chance
  double largest_turn = 15;  ///< degrees between the pair's pose and the camera
};

/// Leaves each pair of photos the matches that agree with the pose of most of them (`ransac_pose`), and none where they
/// are too few. The points are those of the tracks, as prior depth of the photo where they begin has them. Cameras are
/// read, not moved. Drops tracks that no other photo shows any more. The same for any number of threads.
void keep_agreeing_matches(std::vector<Track>& tracks, const std::vector<TrackPhoto>& photos,
                           const PairConsensusSettings& settings, ThreadPool& pool);

}  // namespace aligngs
