// Which neighbours of a pixel the normal of its depth is made of (aligngs.md 4.5, guidance 2.3).
#pragma once

#include <cmath>
#include <cstdint>

#include "engine/losses/depth_map.h"

namespace aligngs {

/// Which neighbours of a pixel stand for one axis of its difference.
enum class Difference : uint8_t { kNone = 0, kCentral = 1, kForward = 2, kBackward = 3 };

inline Difference difference_of(bool before, bool after) {
  if (before && after) return Difference::kCentral;
  if (after) return Difference::kForward;
  return before ? Difference::kBackward : Difference::kNone;
}

/// Horizontal and vertical difference of one pixel; a byte in workspace.stencil.
struct DepthStencil {
  Difference horizontal = Difference::kNone, vertical = Difference::kNone;
  bool valid() const { return horizontal != Difference::kNone && vertical != Difference::kNone; }
  bool central() const { return horizontal == Difference::kCentral && vertical == Difference::kCentral; }
  uint8_t packed() const { return static_cast<uint8_t>(int(horizontal) | int(vertical) << 2); }
  static DepthStencil unpack(uint8_t byte) {
    return {static_cast<Difference>(byte & 3), static_cast<Difference>(byte >> 2)};
  }
};

/// As printed: central differences wherever all five pixels have loose depth validity, so never on the border.
/// Default: tight validity; a one-sided difference where the neighbour on the other side is missing or lies
/// across a depth jump (|dz| / z > 5 %), none where both do.
template <class T>
DepthStencil depth_stencil(const MapLossWorkspace<T>& workspace, int x, int y, int width, int height,
                           bool as_printed) {
  const size_t centre = static_cast<size_t>(y) * width + x;
  const uint8_t least = as_printed ? kDepthLoose : kDepthTight;
  if (workspace.validity[centre] < least) return {};
  const T z = workspace.depth[centre];
  const auto joined = [&](size_t i) {
    return workspace.validity[i] >= least &&
           (as_printed || std::abs(workspace.depth[i] - z) <= T(kDepthJumpShare) * z);
  };
  const DepthStencil stencil{
      difference_of(x > 0 && joined(centre - 1), x + 1 < width && joined(centre + 1)),
      difference_of(y > 0 && joined(centre - width), y + 1 < height && joined(centre + width))};
  return as_printed && !stencil.central() ? DepthStencil{} : stencil;
}

}  // namespace aligngs
