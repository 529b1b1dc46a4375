// How exactly a patch is placed in another photo: sharply at a corner, hardly along an edge.
#pragma once

#include <array>
#include <cstddef>

namespace aligngs {

/// Symmetric, square pixels.
struct MatchCovariance {
  double xx = 0, xy = 0, yy = 0;
};

/// Scores (normalised cross-correlation) of a patch of `pixels` pixels at its best place, in the middle, and one pixel
/// around it, row by row. If noise alone lowers a score below 1, its top has covariance 2 (1 - s) / n H^-1, H its
/// negative second derivatives (Cramer-Rao). Noise of a match is correlated, so a patch counts as fewer pixels than it
/// has. Finite for any finite scores: a direction in which they hardly fall has a deviation of some pixels.
MatchCovariance match_covariance(const std::array<double, 9>& scores, size_t pixels);

/// Lower triangular W with W'W the inverse of the covariance with `deviation` (pixels) added in every direction: W e
/// has unit covariance. {xx, yx, yy}.
std::array<double, 3> whitening(const MatchCovariance& covariance, double deviation);

}  // namespace aligngs
