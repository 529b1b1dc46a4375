// Photos that are not where their cameras say, found by the points of the others.
#pragma once

#include <vector>

#include "refine/camera_refinement.h"

namespace aligngs {

class PhotoFinder {
 public:
  explicit PhotoFinder(CameraRefinement& state);

  /// Forgets what lost and strayed photos seemed to show and looks for them farther off, by the points of the others.
  /// Whether any was found; the others follow their neighbours.
  bool find_lost_photos(double lost_share);
  /// Test photos against the points of the training photos, which they do not move.
  void register_test_views();

  /// Observations of a view that was looked for; 0: it was not placed.
  int observations(size_t view) const { return placed_by_[view]; }
  /// A training view that was found elsewhere.
  bool misplaced(size_t view) const { return misplaced_[view]; }

 private:
  /// Training photos whose matches agree with the cameras far less often than the others', or too rarely at all. Wrong
  /// matches agree with some pose: a wallpaper's pattern fits one flower further, too.
  std::vector<int> lost_photos(double lost_share) const;
  /// Training photos that have moved much farther than the others, each once. Their matches may agree and still be
  /// wrong: a pattern that repeats holds a photo one flower further.
  std::vector<int> strayed_photos();
  /// Puts a photo back to where it was if more points of the others agree with that place than with the one found.
  bool keep_camera(int view, const Camera& camera, const std::vector<int>& others);
  /// Looks for the wanted by the tracks of others, in one way after the other until they are placed. Those that were.
  std::vector<int> place(std::vector<int> wanted, const std::vector<int>& by, const std::vector<PhotoSearch>& searches);

  CameraRefinement& state_;
  std::vector<bool> misplaced_;
  std::vector<bool> checked_;   ///< strayed photos that were looked for
  std::vector<int> placed_by_;  ///< observations by view, of photos looked for by others' tracks
};

}  // namespace aligngs
