#include "refine/photo_finder.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/median.h"

namespace aligngs {

PhotoFinder::PhotoFinder(CameraRefinement& state) : state_(state) {
  const size_t count = state.views.size();
  misplaced_.assign(count, false);
  checked_.assign(count, false);
  placed_by_.assign(count, 0);
}

bool PhotoFinder::find_lost_photos(double lost_share) {
  std::vector<int> lost = lost_photos(lost_share);
  const auto is_lost = [&](int v) { return std::find(lost.begin(), lost.end(), v) != lost.end(); };
  std::vector<std::pair<int, Camera>> strayed;
  for (const int v : strayed_photos()) {
    if (is_lost(v)) continue;
    strayed.emplace_back(v, state_.match(v).camera);
  }
  for (const auto& [v, camera] : strayed) lost.push_back(v);
  if (lost.empty() || lost.size() == state_.train.size()) return false;
  state_.tracks.erase(
      std::remove_if(state_.tracks.begin(), state_.tracks.end(), [&](const Track& t) { return is_lost(t.view); }),
      state_.tracks.end());
  state_.drop_observations([&](const Track&, const Observation& o) { return is_lost(o.view); });
  state_.solve(state_.settings.bundle);
  state_.drop_outliers();
  state_.follow_neighbours();
  std::vector<int> others;
  std::copy_if(state_.train.begin(), state_.train.end(), std::back_inserter(others),
               [&](int v) { return !is_lost(v); });
  std::vector<int> found = place(lost, others, {{state_.settings.lost_search, true}});
  for (const int v : found) misplaced_[static_cast<size_t>(v)] = true;
  for (const auto& [v, camera] : strayed) {
    if (!keep_camera(v, camera, others)) continue;
    misplaced_[static_cast<size_t>(v)] = false;
    found.push_back(v);
  }
  for (const int v : found) state_.by_neighbour[static_cast<size_t>(v)] = false;
  return !found.empty();
}

void PhotoFinder::register_test_views() {
  if (state_.tracks.empty()) return;
  for (const int v : state_.test) state_.by_neighbour[static_cast<size_t>(v)] = true;
  const std::vector<int> found = place(state_.test, state_.train,
                                       {{state_.settings.tracks.match.search, false},
                                        {state_.settings.lost_search, false},
                                        {state_.settings.lost_search, true}});
  for (const int v : found) state_.by_neighbour[static_cast<size_t>(v)] = false;
}

std::vector<int> PhotoFinder::lost_photos(double lost_share) const {
  const std::vector<int> fitting = state_.count_training_observations();
  const auto share = [&](int v) {
    return static_cast<double>(fitting[static_cast<size_t>(v)]) / std::max(1, state_.matched[static_cast<size_t>(v)]);
  };
  std::vector<double> shares;
  for (const int v : state_.train) shares.push_back(share(v));
  if (shares.empty()) return {};
  const double least = lost_share * median_of(std::move(shares));
  std::vector<int> lost;
  std::copy_if(state_.train.begin(), state_.train.end(), std::back_inserter(lost), [&](int v) {
    return fitting[static_cast<size_t>(v)] < state_.settings.least_observations || share(v) < least;
  });
  return lost;
}

std::vector<int> PhotoFinder::strayed_photos() {
  const auto shift = [&](int v) {
    return norm(state_.match(v).camera.centre() - state_.prior[static_cast<size_t>(v)].centre());
  };
  std::vector<double> shifts;
  for (const int v : state_.train) shifts.push_back(shift(v));
  if (shifts.empty()) return {};
  const double most =
      std::max(state_.settings.bundle.centre * state_.extent, state_.settings.stray_factor * median_of(shifts));
  std::vector<int> strayed;
  for (size_t i = 0; i < state_.train.size(); ++i) {
    const int v = state_.train[i];
    if (!(shifts[i] > most) || checked_[static_cast<size_t>(v)]) continue;
    checked_[static_cast<size_t>(v)] = true;
    strayed.push_back(v);
  }
  return strayed;
}

bool PhotoFinder::keep_camera(int view, const Camera& camera, const std::vector<int>& others) {
  const size_t v = static_cast<size_t>(view);
  const Camera found = state_.match(view).camera;
  const int agreeing = placed_by_[v];
  state_.matches[v].camera.world_to_camera = camera.world_to_camera;
  place({view}, others, {{state_.settings.tracks.near_search, false}});
  if (placed_by_[v] > agreeing) return true;
  state_.matches[v].camera = found;
  placed_by_[v] = agreeing;
  return false;
}

std::vector<int> PhotoFinder::place(std::vector<int> wanted, const std::vector<int>& by,
                                    const std::vector<PhotoSearch>& searches) {
  const std::vector<TrackPhoto> photos = state_.track_photos(by);
  std::vector<int> found;
  for (const PhotoSearch& search : searches) {
    std::vector<WantedPhoto> tried;
    for (const int v : wanted)
      tried.push_back({v, &state_.matches[static_cast<size_t>(v)], &state_.views[static_cast<size_t>(v)].mask, 0});
    place_photos({state_.tracks, photos, state_.extent}, tried, search, state_.settings, state_.pool);
    wanted.clear();
    for (const WantedPhoto& photo : tried) {
      placed_by_[static_cast<size_t>(photo.view)] = photo.observations;
      (photo.observations > 0 ? found : wanted).push_back(photo.view);
    }
  }
  return found;
}

}  // namespace aligngs
