// Cameras and tracks of a refinement while it lasts, and their adjustment to each other.
#pragma once

#include <algorithm>
#include <vector>

#include "refine/refine_cameras.h"

namespace aligngs {

/// Shared by the steps of refine_cameras(), which change it in turn.
class CameraRefinement {
 public:
  CameraRefinement(const std::vector<RefineView>& views, double extent, const RefineSettings& settings,
                   ThreadPool& pool);

  const MatchView& match(int view) const { return matches[static_cast<size_t>(view)]; }
  std::vector<TrackPhoto> track_photos(const std::vector<int>& views) const;

  /// Cameras and points of the training views, outliers dropped in between.
  void adjust();
  void solve(const BundleSettings& settings);
  void drop_outliers();
  /// And tracks that fewer than two photos are left of.
  template <class Unwanted>
  void drop_observations(const Unwanted& unwanted);
  /// Test views, and those that see too little, keep their prior pose relative to the nearest view that sees enough.
  void follow_neighbours();

  /// By view.
  std::vector<int> count_training_observations() const;

  const RefineSettings& settings;
  const double extent;
  ThreadPool& pool;
  const std::vector<RefineView>& views;
  std::vector<MatchView> matches;  ///< as the views', with the cameras of the moment
  std::vector<Camera> prior;
  std::vector<int> train, test;
  std::vector<Track> tracks;
  std::vector<bool> by_neighbour;
  std::vector<int> matched;  ///< observations by view before the last round's outliers were dropped
  BundleReport bundle;
  double focal_factor = 1;

 private:
  void share_focal();
  BundleProblem without_observations() const;
  BundleProblem problem() const;
  void take(const BundleProblem& solved);
  int nearest_anchor(int view, const std::vector<int>& counts) const;
  Rigidd carried_pose(int view, int anchor) const;

  bool adjusted_ = false;
};

template <class Unwanted>
void CameraRefinement::drop_observations(const Unwanted& unwanted) {
  for (Track& t : tracks) {
    t.observations.erase(std::remove_if(t.observations.begin(), t.observations.end(),
                                        [&](const Observation& o) { return unwanted(t, o); }),
                         t.observations.end());
  }
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(), [](const Track& t) { return t.observations.size() < 2; }),
               tracks.end());
}

}  // namespace aligngs
