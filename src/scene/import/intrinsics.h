// Intrinsics that come as a matrix alone, without the size of their photos.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aligngs {

struct Intrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  int width = 0, height = 0;              ///< pixels of the photos that they are for; 0: not known
  std::filesystem::path file{};           ///< that has them, for errors
};

/// Why numbers are no matrix of intrinsics, rows first, of 3 or 4 rows as `side` says; empty where they are. Skew is not
/// supported, and the last row shows a column-major matrix.
std::string fault_of_matrix(const std::vector<double>& numbers, size_t side);

/// A 3x3 or 4x4 matrix, or the four numbers fx fy cx cy. Error{kBadInput} for anything else.
Intrinsics read_intrinsics(const std::filesystem::path& file);

/// Why a principal point cannot be that of a photo of width x height pixels; empty where it can. It lies near the
/// middle of the photo that it was measured for. Photos that were resized or turned since show in both coordinates. A
/// single one may be far off, as after a crop.
std::string misfit_of_intrinsics(double cx, double cy, int width, int height);

}  // namespace aligngs
