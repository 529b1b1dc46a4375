// A way of a camera through key frames: where it is and where it looks at any time.
#pragma once

#include <vector>

#include "scene/camera.h"

namespace aligngs {

inline constexpr double kNarrowestView = 5, kWidestView = 150;  ///< degrees between the edges of a picture
inline constexpr double kShortestSight = 1e-6;                  ///< scene units between an eye and its target

struct CameraKey {
  double time = 0;    ///< seconds
  Vec3d eye, target;  ///< scene units; apart from each other
  double fov = 62;    ///< degrees between the lower and the upper edge of the picture
};

struct CameraPath {
  std::vector<CameraKey> keys;  ///< at least one; times rise strictly

  double begin() const { return keys.front().time; }
  double duration() const { return keys.back().time - keys.front().time; }  ///< seconds
};

/// The camera at a time, by cubic Hermite curves through the keys (Catmull-Rom tangents for unequal times). The first
/// and the last key hold before and after. A path whose last key is its first one is a loop without a corner.
CameraKey key_at(const CameraPath& path, double time);

/// The same way in `seconds` > 0. A path of one key stays as it is.
CameraPath stretched(CameraPath path, double seconds);

/// A pinhole camera of `width` x `height` pixels. `up`: unit, world.
Camera camera_of(const CameraKey& key, const Vec3d& up, int width, int height);

}  // namespace aligngs
