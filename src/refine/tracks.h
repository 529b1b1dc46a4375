// Corners of photos, and the places where other photos show them.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "refine/bundle_adjustment.h"
#include "refine/guided_match.h"
#include "refine/search_photos.h"
#include "scene/corners.h"

namespace aligngs {

/// A corner of one photo and where others show it.
struct Track {
  int view = 0;  ///< of the corner
  Corner corner;
  Vec3d point;                            ///< scene units; at first where that photo's depth says
  std::vector<Observation> observations;  ///< the first is the corner itself
};

struct TrackSettings {
  /// Weak corners too: a kitchen's bare fronts have few strong ones, and each match weighs as exactly as it is placed.
  CornerSettings corners{4000, 3, 0.001};
  int wide_corners = 2000;    ///< per photo in a wide search: there the weak ones are mistaken for others more often
  MatchSettings match;        ///< its `search` is the wide one
  double near_search = 0.02;  ///< of the image width, once cameras are about right
  int neighbours = 20;        ///< photos that a corner is looked for in: those that see most of the same
  /// of a photo's pixels inside of the other: a few matches can be all that holds two groups together
  double least_overlap = 0.05;
  double largest_turn = 90;  ///< degrees between viewing directions
};

/// Choice of a photo's corners for a search within `search` of the image width. A small photo gets fewer than one of
/// 320 x 240. A larger one gets no more, but as far apart in proportion. Each is placed more exactly there, and its
/// search takes longer. A wide search makes do with fewer.
CornerSettings corners_for_search(const TrackSettings& settings, const ImageF& luma, double search);

/// Tracks, photo by photo, of the corners of every photo that have depth and are found in at least one other. They are
/// searched within `search` of the image width around the place that depth and cameras predict. A search beyond
/// TrackSettings::near_search looks at small copies (`SearchPhotos`), so that its places are rougher. The same for any
/// number of threads.
std::vector<Track> find_tracks(const std::vector<TrackPhoto>& photos, double search, const TrackSettings& settings,
                               ThreadPool& pool);

/// Places at which the photos of `wanted`, whose depth is not read, show the points of tracks that begin in `photos`.
/// Observation::point is the track's index.
std::vector<Observation> find_points(const std::vector<Track>& tracks, const std::vector<TrackPhoto>& photos,
                                     const std::vector<TrackPhoto>& wanted, double search,
                                     const TrackSettings& settings, ThreadPool& pool);

}  // namespace aligngs
