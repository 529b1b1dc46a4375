#include "refine/pair_consensus.h"

#include <algorithm>
#include <map>
#include <utility>

namespace aligngs {
namespace {

/// An observation of a track: its numbers.
struct Place {
  size_t track = 0, observation = 0;
};

/// Whether each match of a pair agrees with the pair's pose.
std::vector<bool> agreeing(const Camera& camera, const std::vector<PointMatch>& matches,
                           const PairConsensusSettings& settings) {
  if (static_cast<int>(matches.size()) < settings.judged) return std::vector<bool>(matches.size(), true);
  std::vector<bool> out(matches.size(), false);
  PoseSearchSettings search;
  search.samples = settings.samples;
  search.agreement = settings.agreement * camera.width;
  search.largest_turn = settings.largest_turn;
  const auto pose = ransac_pose(camera, matches, search);
  if (!pose || pose->agreeing < settings.least ||
      pose->agreeing < settings.least_share * static_cast<double>(matches.size()))
    return out;
  for (size_t i = 0; i < matches.size(); ++i)
    out[i] = reprojection_error(pose->camera, matches[i].point, matches[i].pixel) < search.agreement;
  return out;
}

}  // namespace

void keep_agreeing_matches(std::vector<Track>& tracks, const std::vector<TrackPhoto>& photos,
                           const PairConsensusSettings& settings, ThreadPool& pool) {
  std::map<std::pair<int, int>, std::vector<Place>> by_pair;
  for (size_t t = 0; t < tracks.size(); ++t) {
    for (size_t i = 1; i < tracks[t].observations.size(); ++i)
      by_pair[{tracks[t].view, tracks[t].observations[i].view}].push_back({t, i});
  }
  std::map<int, const TrackPhoto*> photo_of_view;
  for (const TrackPhoto& photo : photos) photo_of_view[photo.view] = &photo;
  struct Pair {
    const Camera* camera;
    const std::vector<Place>* places;
    std::vector<bool> kept;
  };
  std::vector<Pair> pairs;
  for (const auto& [views, places] : by_pair)
    pairs.push_back({&photo_of_view.at(views.second)->match->camera, &places, {}});
  pool.parallel_for(pairs.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t p = begin; p < end; ++p) {
      std::vector<PointMatch> matches;
      for (const Place& place : *pairs[p].places)
        matches.push_back({tracks[place.track].point, tracks[place.track].observations[place.observation].pixel});
      pairs[p].kept = agreeing(*pairs[p].camera, matches, settings);
    }
  });
  std::vector<std::vector<Observation>> kept(tracks.size());
  for (size_t t = 0; t < tracks.size(); ++t) kept[t].push_back(tracks[t].observations.front());
  for (const Pair& pair : pairs) {
    for (size_t i = 0; i < pair.kept.size(); ++i) {
      const Place& place = (*pair.places)[i];
      if (pair.kept[i]) kept[place.track].push_back(tracks[place.track].observations[place.observation]);
    }
  }
  for (size_t t = 0; t < tracks.size(); ++t) tracks[t].observations = std::move(kept[t]);
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(), [](const Track& t) { return t.observations.size() < 2; }),
               tracks.end());
}

}  // namespace aligngs
