// Planes of everything that was measured in the photos, whatever it is: nothing is labelled.
#pragma once

#include <optional>
#include <vector>

#include "core/thread_pool.h"
#include "refine/guided_match.h"
#include "refine/room_axes.h"
#include "refine/scene_planes.h"

namespace aligngs {

/// Settings of find_planes() for points of all kinds of surfaces.
inline PlaneSettings planes_of_anything() {
  PlaneSettings settings;
  settings.inlier = 0.02;
  settings.normal_angle = 20;
  settings.candidates = 600;
  settings.least_share = 0.008;
  settings.merge_angle = 5;
  settings.merge_distance = 0.02;
  return settings;
}

/// And where the room is built square: of points that face along its axes exactly.
inline PlaneSettings planes_along_axes() {
  PlaneSettings settings = planes_of_anything();
  settings.inlier = 0.016;
  settings.normal_angle = 5;
  settings.candidates = 300;
  settings.least_share = 0.005;
  return settings;
}

/// And of smaller surfaces, where no labels tell walls and floors apart.
inline PlaneSettings small_planes_along_axes() {
  PlaneSettings settings = planes_along_axes();
  settings.least_share = 0.002;
  settings.turn_sigma = 1.5;  // few points tell the turn of a small plane, and square rooms have none
  return settings;
}

struct MeasuredPlaneSettings {
  PlaneSettings anything = planes_of_anything();
  PlaneSettings along_axes = planes_along_axes();
  RoomAxesSettings axes;
  std::optional<RoomAxes> known_axes;  ///< of the room; without them the planes themselves tell
  int stride = 2;                      ///< pixels between the points that planes are found with
  size_t most = 30;                    ///< planes; those with the most points stay
};

/// One photo: depth of the pixels that were measured (0 = none), and how surely in [0, 1]. Both H x W; may be empty.
struct MeasuredView {
  Camera camera;
  ImageF depth, certainty;
  Image<uint16_t> labels;  ///< H x W: class of each pixel, kNoLabel = none; empty: the photo has no labels
};

/// Planes by falling number of points. In a room that is built square, all face along its axes, within `axes.angle`.
/// These directions are known better than the normals of small windows, so small planes are found, too.
/// Deterministic for any number of threads.
std::vector<ScenePlane> measured_planes(const std::vector<MeasuredView>& views, const MeasuredPlaneSettings& settings,
                                        ThreadPool& pool);

}  // namespace aligngs
