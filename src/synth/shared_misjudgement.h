// Regions of a room whose depth a feed-forward network misjudges in every view alike.
#pragma once

#include <array>

#include "core/random.h"
#include "core/rigid.h"

namespace aligngs {

struct SharedMisjudgementOptions {
  double share = 0.15;  ///< of space where surfaces are displaced
  double size = 0.1;    ///< metres along the surface normal there, mean of the absolute value (about)
};

/// The error of real networks is coherent between views: they share the cues that mislead them. A random smooth
/// field over the room decides where, another one by how much and to which side a surface is displaced. Unlike the
/// world's bend (world_bend.h) it leaves the cameras where they are.
class SharedMisjudgement {
 public:
  SharedMisjudgement() = default;  ///< none
  SharedMisjudgement(const SharedMisjudgementOptions& options, Random& random);

  /// Metres by which the surface at the world point x moves along its normal.
  double operator()(const Vec3d& x) const;

 private:
  /// Sum of cosines of random direction: near a Gaussian field of unit variance.
  struct Field {
    static constexpr int kModes = 16;
    std::array<Vec3d, kModes> waves{};  ///< 1/m
    std::array<double, kModes> phases{};
    void draw(Random& random);
    double operator()(const Vec3d& x) const;
  };
  Field where_, side_;
  double level_ = 0, gain_ = 0;
};

/// The level that a standard normal value exceeds with the given probability (logistic approximation).
double upper_quantile(double share);

}  // namespace aligngs
