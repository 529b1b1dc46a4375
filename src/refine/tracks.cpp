#include "refine/tracks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "refine/view_overlap.h"

namespace aligngs {
namespace {

constexpr double kFewestInWideSearch = 600;  // corners of a photo; they find cameras to some pixels

/// For every photo of `from` the indices into `to` of those that see most of the same.
std::vector<std::vector<int>> neighbours(const std::vector<TrackPhoto>& from, const std::vector<TrackPhoto>& to, int count,
                                         const TrackSettings& settings) {
  const auto matches = [](const std::vector<TrackPhoto>& photos) {
    std::vector<const MatchView*> out;
    for (const TrackPhoto& photo : photos) out.push_back(photo.match);
    return out;
  };
  return overlapping_views(matches(from), matches(to), count, settings.least_overlap, settings.largest_turn);
}

Observation observation(const TrackPhoto& photo, const Vec2d& pixel) {
  Observation o;
  o.view = photo.view;
  o.pixel = pixel;
  const ImageF& depth = photo.match->depth;
  if (!depth.empty() && photo.match->camera.contains(pixel)) {
    const float z = depth.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
    o.prior_depth = z > 0 && std::isfinite(z) ? static_cast<double>(z) : 0;
  }
  return o;
}

/// Without observations where the corner has no depth.
Track start_track(const TrackPhoto& photo, const Corner& corner) {
  Track track;
  track.view = photo.view;
  track.corner = corner;
  const Observation own = observation(photo, {corner.x + 0.5, corner.y + 0.5});
  if (own.prior_depth <= 0) return track;
  track.point = photo.match->camera.unproject(own.pixel.x, own.pixel.y, own.prior_depth);
  track.observations.push_back(own);
  return track;
}

}  // namespace

CornerSettings corners_for_search(const TrackSettings& settings, const ImageF& luma, double search) {
  CornerSettings corners = settings.corners;
  const double size = relative_size(luma);
  const bool wide = search > settings.near_search;
  double most = (wide ? std::min(corners.per_view, settings.wide_corners) : corners.per_view) * std::min(size, 1.0);
  if (size > 1) {
    corners.spacing = static_cast<int>(std::lround(corners.spacing * std::sqrt(size)));
    if (wide) most = std::max(std::min(most, kFewestInWideSearch), most / size);
  }
  corners.per_view = static_cast<int>(std::lround(most));
  return corners;
}

std::vector<Track> find_tracks(const std::vector<TrackPhoto>& photos, double search, const TrackSettings& settings, ThreadPool& pool) {
  MatchSettings match_settings = settings.match;
  match_settings.search = search;
  const auto near = neighbours(photos, photos, settings.neighbours, settings);
  const ImageF no_mask;
  std::vector<std::vector<Track>> of_photo(photos.size());
  pool.parallel_for(photos.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const MatchView& from = *photos[i].match;
      const ImageF& mask = photos[i].mask ? *photos[i].mask : no_mask;
      for (const Corner& corner : find_corners(from.luma, mask, corners_for_search(settings, from.luma, search))) {
        Track track = start_track(photos[i], corner);
        if (track.observations.empty()) continue;
        for (const int k : near[i]) {
          const TrackPhoto& other = photos[static_cast<size_t>(k)];
          if (const auto found = guided_match(from, corner.x, corner.y, *other.match, match_settings)) {
            track.observations.push_back(observation(other, found->pixel));
            track.observations.back().covariance = found->covariance;
          }
        }
        if (track.observations.size() >= 2) of_photo[i].push_back(std::move(track));
      }
    }
  });
  std::vector<Track> tracks;
  for (auto& own : of_photo) std::move(own.begin(), own.end(), std::back_inserter(tracks));
  return tracks;
}

std::vector<Observation> find_points(const std::vector<Track>& tracks, const std::vector<TrackPhoto>& photos,
                                     const std::vector<TrackPhoto>& wanted, double search, const TrackSettings& settings, ThreadPool& pool) {
  MatchSettings match_settings = settings.match;
  match_settings.search = search;
  const auto near = neighbours(photos, wanted, static_cast<int>(wanted.size()), settings);
  std::map<int, size_t> photo_of_view;
  for (size_t i = 0; i < photos.size(); ++i) photo_of_view[photos[i].view] = i;
  constexpr size_t kTracksAtATime = 64;  // milliseconds of work
  std::vector<std::vector<Observation>> found(tracks.size());
  pool.parallel_for(tracks.size(), kTracksAtATime, [&](size_t begin, size_t end, int) {
    for (size_t t = begin; t < end; ++t) {
      const Track& track = tracks[t];
      const size_t from = photo_of_view.at(track.view);
      for (const int k : near[from]) {
        const TrackPhoto& photo = wanted[static_cast<size_t>(k)];
        const auto place = guided_match(*photos[from].match, track.corner.x, track.corner.y, *photo.match, match_settings);
        if (!place) continue;
        Observation o;
        o.view = photo.view;
        o.point = static_cast<int>(t);
        o.pixel = place->pixel;
        o.covariance = place->covariance;
        found[t].push_back(o);
      }
    }
  });
  std::vector<Observation> all;
  for (const auto& own : found) all.insert(all.end(), own.begin(), own.end());
  return all;
}

}  // namespace aligngs
