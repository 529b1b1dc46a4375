// Finds the up direction of a world that does not state it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/camera.h"

namespace aligngs {

struct UpDirection {
  Vec3d direction;     ///< unit, world
  std::string source;  ///< for scene.json: what it was concluded from
};

/// A camera's place and the direction in the world that is up in its picture.
struct ViewUp {
  Vec3d centre, up;
};

/// For a picture that was held as its EXIF orientation (1 to 8) says; 1 where the pixels are upright.
ViewUp view_up(const Rigidd& world_to_camera, int orientation = 1);

/// From the plane through the points labelled as floor, else from the plane of the points below the cameras. Else from
/// the mean up of the cameras. A plane counts within 30 degrees of that mean. Empty without cameras and when their ups
/// cancel each other.
std::optional<UpDirection> estimate_up(const std::vector<ViewUp>& views, const std::vector<Vec3d>& floor,
                                       const std::vector<Vec3d>& points);

/// Whether the up that a layout gives agrees with the cameras. `measured`: a sensor of gravity gave it. Then nothing but
/// cameras that hang upside down on the mean contradict. Else it is a convention that not every file keeps: cameras
/// whose ups agree with each other contradict from 60 degrees on. Photos that were held upright and stored lying have ups
/// that cancel each other as the camera turns: they say nothing.
bool agrees_with(const std::vector<ViewUp>& views, const Vec3d& up, bool measured);

}  // namespace aligngs
