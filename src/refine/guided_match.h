// The same surface point in another photo, searched near where prior depth and cameras expect it.
#pragma once

#include <optional>

#include "core/image.h"
#include "refine/match_covariance.h"
#include "scene/camera.h"

namespace aligngs {

/// Input of matching for a photo; all maps H x W x 1 of the camera's size.
struct MatchView {
  Camera camera;
  ImageF luma;   ///< [0, 1]
  ImageF depth;  ///< prior depth, scene units, 0 = none; may be empty for a photo that is only searched
};

struct MatchSettings {
  int half_patch = 5;            ///< pixels to each side of the corner that are compared
  double search = 0.05;          ///< of the image width: how far from the expected place
  double least_score = 0.75;     ///< normalised cross-correlation of an accepted match
  double least_margin = 0.04;    ///< above the best score elsewhere in the window: repeated texture has none
  int elsewhere = 4;             ///< pixels from the best place that count as elsewhere
  double depth_jump = 0.05;      ///< relative; patches across a depth discontinuity show two surfaces
  double least_contrast = 0.02;  ///< standard deviation of the patch's luma
};

struct Match {
  Vec2d pixel;                 ///< in the other photo, sub-pixel, centre of pixel (x, y) is (x + 0.5, y + 0.5)
  double score = 0;            ///< normalised cross-correlation, at most 1
  MatchCovariance covariance;  ///< of `pixel`
};

/// The patch around (x, y) of `from` is carried over by its own depth, pixel for pixel, so that slanted surfaces match.
/// It is slid over a window of `to`. Nothing when it lies outside, has no depth, no contrast, or no unique place.
std::optional<Match> guided_match(const MatchView& from, int x, int y, const MatchView& to,
                                  const MatchSettings& settings);

}  // namespace aligngs
