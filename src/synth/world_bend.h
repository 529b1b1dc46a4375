// The smooth deformation of space that a feed-forward reconstruction network applies to a whole scene at once.
#pragma once

#include <array>

#include "core/random.h"
#include "core/rigid.h"

namespace aligngs {

struct WorldBendOptions {
  double rms = 0.018;       ///< of the smooth modes' displacement, metres
  double bend_degrees = 3;  ///< angle by which opposite walls are no longer parallel
  double extent = 4.5;      ///< size of the room along the bend, metres
};

/// x -> x + f(x): four sinusoidal modes with wavelengths of 1.5 to 4 m, and a bend of one horizontal axis onto an
/// arc. Surfaces and cameras share it, which is why a network's fusion looks crisp
/// and is still wrong.
class WorldBend {
 public:
  WorldBend() = default;  ///< no deformation
  /// `centre` stays in place; `up` is the world's unit up vector.
  WorldBend(const WorldBendOptions& options, const Vec3d& centre, const Vec3d& up, Random& random);

  Vec3d operator()(const Vec3d& x) const;  ///< the deformed point
  Mat3d jacobian(const Vec3d& x) const;    ///< of the map, by central differences
  /// The rotation nearest to the Jacobian: how a camera at x turns.
  Mat3d rotation(const Vec3d& x) const;

 private:
  struct Mode {
    Vec3d wave, direction;  ///< 1/m and metres
    double phase = 0;
  };
  std::array<Mode, 4> modes_{};
  int mode_count_ = 0;
  Vec3d centre_, along_, side_;
  double curvature_ = 0;  ///< 1/m
};

}  // namespace aligngs
