// The splats of a PLY file as columns of numbers, for what the page loads.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace aligngs {

/// Row i of every column belongs to splat i, in the units of the file.
struct SplatTable {
  std::array<std::vector<float>, 3> position;   ///< scene units
  std::array<std::vector<float>, 3> color;      ///< f_dc: spherical harmonics of degree 0
  std::vector<float> opacity;                   ///< logit
  std::array<std::vector<float>, 3> log_scale;  ///< natural logarithm of the standard deviations
  std::array<std::vector<float>, 4> rotation;   ///< quaternion w x y z, as in the file
  int sh_degree = 0;                            ///< 0 to 3
  std::vector<std::vector<float>> harmonics;    ///< f_rest: 3 ((degree + 1)^2 - 1) columns, channel-major
  std::vector<uint16_t> label, instance;        ///< empty without labels
  std::vector<uint8_t> confidence;              ///< probability of the class x 255; empty without labels

  size_t size() const { return opacity.size(); }
};

/// Error{kBadInput} for what is no PLY file of splats. Numbers that are not finite become 0. Columns of higher
/// harmonics that are 0 everywhere are left out, with their degree.
SplatTable read_splat_table(const std::string& ply, const std::filesystem::path& name_for_errors);

}  // namespace aligngs
