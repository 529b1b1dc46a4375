// Exact pose of a photo, by comparing it with the finished scene from there. The scene stays as it is.
#pragma once

#include <functional>
#include <optional>

#include "core/image.h"
#include "scene/camera.h"

namespace aligngs {

/// A scene as a camera sees it.
struct SceneLook {
  ImageF color;  ///< H x W x 3, as the photo
  ImageF depth;  ///< H x W, z of the camera, 0 = nothing to be seen
};
/// Renders at the camera's size.
using LookAtScene = std::function<SceneLook(const Camera&)>;

struct PhotoAlignmentSettings {
  int levels = 3;            ///< sizes, each half of the one before; the smallest first, which sees far shifts
  int steps = 8;             ///< renderings per size at most
  double scale = 0.05;       ///< grey, of 1: of Cauchy's norm; far beyond, a pixel shows something else than the scene
  double depth_jump = 0.05;  ///< relative: neighbours that far apart are an edge, which moves otherwise than its pixels
  double least_share = 0.05;  ///< of the pixels must show a surface
  double still = 0.01;        ///< pixels: a step whose median motion is smaller ends a size
};

struct PhotoAlignment {
  Camera camera;                 ///< the pose alone may differ from that of the start
  SceneLook seen;                ///< the scene from there
  double before = 0, after = 0;  ///< mean norm of the grey differences at full size; 0 where nothing is seen
  int renderings = 0;
};

/// A photo, and the camera from which its pose is sought.
struct PhotoToAlign {
  Camera start;
  ImageF color;  ///< H x W x 3 of the camera's size
  ImageF mask;   ///< H x W, 0 = ignored; empty: every pixel counts
  /// The scene from the start, where it is rendered already.
  std::optional<SceneLook> seen{};
};

/// Direct alignment (Lucas-Kanade over the pixels' surfaces; Kerl et al. 2013) of six numbers of the pose and two of
/// the photo's brightness, by Levenberg-Marquardt. Returns the start if the photo gives nothing better: no contrast,
/// too little of the scene in view, or no smaller difference in the end. Error{kFailed} for maps of another size.
PhotoAlignment align_to_photo(PhotoToAlign photo, const LookAtScene& look, const PhotoAlignmentSettings& settings = {});

}  // namespace aligngs
