#include "refine/tracks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "refine/view_overlap.h"

namespace aligngs {
namespace {

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

/// Without observations where the corner, at `pixel` of the photo, has no depth.
Track start_track(const TrackPhoto& photo, const Vec2d& pixel, float strength) {
  Track track;
  track.view = photo.view;
  track.corner = {strength, static_cast<int>(pixel.x), static_cast<int>(pixel.y)};
  const Observation own = observation(photo, pixel);
  if (own.prior_depth <= 0) return track;
  track.point = photo.match->camera.unproject(own.pixel.x, own.pixel.y, own.prior_depth);
  track.observations.push_back(own);
  return track;
}

MatchSettings with_search(MatchSettings settings, double search) {
  settings.search = search;
  return settings;
}

Vec2d middle(int x, int y) { return {x + 0.5, y + 0.5}; }

}  // namespace

CornerSettings corners_for_search(const TrackSettings& settings, const ImageF& luma, double search) {
  CornerSettings corners = settings.corners;
  const double size = relative_size(luma);
  const bool wide = search > settings.near_search;
  const double most =
      (wide ? std::min(corners.per_view, settings.wide_corners) : corners.per_view) * std::min(size, 1.0);
  if (size > 1) corners.spacing = static_cast<int>(std::lround(corners.spacing * std::sqrt(size)));
  corners.per_view = static_cast<int>(std::lround(most));
  return corners;
}

std::vector<Track> find_tracks(const std::vector<TrackPhoto>& photos, double search, const TrackSettings& settings,
                               ThreadPool& pool) {
  const MatchSettings match_settings = with_search(settings.match, search);
  const SearchPhotos searched(photos, search > settings.near_search);
  const auto near = overlapping_views(searched.matches(), searched.matches(), settings.neighbours,
                                      settings.least_overlap, settings.largest_turn);
  std::vector<std::vector<Track>> of_photo(photos.size());
  pool.parallel_for(photos.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const MatchView& from = searched.match(i);
      for (const Corner& corner :
           find_corners(from.luma, searched.mask(i), corners_for_search(settings, from.luma, search))) {
        Track track = start_track(photos[i], searched.to_given(i, middle(corner.x, corner.y)), corner.strength);
        if (track.observations.empty()) continue;
        for (const int k : near[i]) {
          const size_t other = static_cast<size_t>(k);
          if (const auto found = guided_match(from, corner.x, corner.y, searched.match(other), match_settings)) {
            const Match match = searched.to_given(other, *found);
            track.observations.push_back(observation(photos[other], match.pixel));
            track.observations.back().covariance = match.covariance;
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
                                     const std::vector<TrackPhoto>& wanted, double search,
                                     const TrackSettings& settings, ThreadPool& pool) {
  const MatchSettings match_settings = with_search(settings.match, search);
  const bool wide = search > settings.near_search;
  const SearchPhotos begun(photos, wide), searched(wanted, wide);
  const auto near = overlapping_views(begun.matches(), searched.matches(), static_cast<int>(wanted.size()),
                                      settings.least_overlap, settings.largest_turn);
  std::map<int, size_t> photo_of_view;
  for (size_t i = 0; i < photos.size(); ++i) photo_of_view[photos[i].view] = i;
  constexpr size_t kTracksAtATime = 64;  // milliseconds of work
  std::vector<std::vector<Observation>> found(tracks.size());
  pool.parallel_for(tracks.size(), kTracksAtATime, [&](size_t begin, size_t end, int) {
    for (size_t t = begin; t < end; ++t) {
      const Track& track = tracks[t];
      const size_t from = photo_of_view.at(track.view);
      const Vec2d corner = middle(track.corner.x, track.corner.y), inside = begun.from_given(from, corner);
      const int x = static_cast<int>(inside.x), y = static_cast<int>(inside.y);
      const Vec2d looked_for = begun.to_given(from, middle(x, y));  // in a copy the corner lies beside a pixel's middle
      for (const int k : near[from]) {
        const size_t photo = static_cast<size_t>(k);
        const auto place = guided_match(begun.match(from), x, y, searched.match(photo), match_settings);
        if (!place) continue;
        const Match match = searched.to_given(photo, *place);
        Observation o;
        o.view = wanted[photo].view;
        o.point = static_cast<int>(t);
        o.pixel = {match.pixel.x + corner.x - looked_for.x, match.pixel.y + corner.y - looked_for.y};
        o.covariance = match.covariance;
        found[t].push_back(o);
      }
    }
  });
  std::vector<Observation> all;
  for (const auto& own : found) all.insert(all.end(), own.begin(), own.end());
  return all;
}

}  // namespace aligngs
