// Neighbouring pixels that the teacher gives different classes, and where normals are compared beside them
// (settings loss.crease and loss.normal_boundary).
#pragma once

namespace aligngs {

/// A pair (first, second) of horizontal or vertical neighbours across a label edge.
struct LabelPair {
  int x = 0, y = 0;    ///< first pixel
  int dx = 0, dy = 0;  ///< step to the second: (1, 0) or (0, 1)
};

/// The prior's shape of the surface at a label edge.
enum class EdgeKind { kNothing, kCrease, kCoplanar };

inline constexpr double kCreaseAngleDegrees = 25;    ///< prior normals that differ by more fold the surface here
inline constexpr double kCreaseJumpShare = 0.03;     ///< and the surface is unbroken: |dz| / z below this
inline constexpr double kCoplanarAngleDegrees = 10;  ///< prior normals that differ by less lie in one plane
inline constexpr double kCoplanarJumpShare = 0.01;   ///< when also |dz| / z is below this
inline constexpr int kCreasePriorOffset = 4;         ///< pixels from the edge at which prior normals are read
inline constexpr int kCreaseRenderOffset = 2;        ///< pixels from the edge at which rendered normals are compared
inline constexpr double kCreaseMinimumShare = 0.01;  ///< the sum is divided by at least this share of the pixels

}  // namespace aligngs
