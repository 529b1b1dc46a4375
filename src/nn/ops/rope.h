// Rotary position embedding in two dimensions, as VGGT and DA3 use it.
#pragma once

#include <cstdint>
#include <vector>

#include "nn/values.h"

namespace aligngs::nn {

/// The first half of a head rotates with y, the second with x. For a half of size D the frequencies
/// are frequency^(-2j/D), j < D/2; value j is paired with value j + D/2.
class Rope2d {
 public:
  /// head_dim is a multiple of 4; positions are integers in [0, largest].
  Rope2d(int64_t head_dim, int64_t largest, double frequency = 100);
  /// Position p turns value j by angles[p * head_dim / 4 + j] radians, whatever rule made them.
  Rope2d(int64_t head_dim, const std::vector<double>& angles);
  void rotate(float* head, int64_t y, int64_t x) const;
  const Values& cosines() const { return cos_; }  ///< [position][head_dim / 4]
  const Values& sines() const { return sin_; }

 private:
  void rotate_half(float* half, int64_t position) const;

  int64_t quarter_;
  Values cos_, sin_;  ///< [position][quarter]
};

}  // namespace aligngs::nn
