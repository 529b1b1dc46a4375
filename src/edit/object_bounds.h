// Bounds of an object that comes from a file of splats: a room with it must stay a room.
#pragma once

#include <filesystem>

#include "gaussians/gaussian_model.h"

namespace aligngs {

/// Lengths are shares of the size of an object. The size is the diagonal of the box of its places, without one percent
/// of strays on each side. Six standard deviations of its middle Gaussian are added.
struct ObjectBounds {
  /// From the middle to a Gaussian. Packed formats share their steps out up to the farthest Gaussian of the room.
  double farthest = 100;
  double largest = 10;  ///< standard deviation of a Gaussian: more covers the room
  double step = 1e-3;   ///< between neighbouring 32-bit numbers at the places: more loses the shape
  double most = 1e6;    ///< size in units of the file: 32-bit numbers have steps of 6 cm there
};

/// Error{kBadInput} with file, field and remedy for an object beyond the bounds, and for one that nobody can see.
void require_object_bounds(const GaussianModel& model, const std::filesystem::path& file,
                           const ObjectBounds& bounds = {});

}  // namespace aligngs
