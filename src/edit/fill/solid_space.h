// The space that some Gaussians take, as cubes: what it hides from an eye.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "gaussians/gaussian_model.h"

namespace aligngs {

class SolidSpace {
 public:
  /// `selected` marks rows; those that are solid fill cubes with edge `cube`, scene units. Cubes are larger where the
  /// space would have more than 256 on a side.
  SolidSpace(const GaussianModel& model, const std::vector<uint8_t>& selected, double cube);

  bool empty() const { return counts_[0] == 0; }
  /// Whether the segment from an eye to a place passes through the space. The last two and a half cubes before the
  /// place do not count: a surface does not hide itself.
  bool hides(const Vec3d& eye, const Vec3d& place) const;

 private:
  void find_clear_blocks();

  double cube_ = 1;
  Vec3d low_;
  int counts_[3] = {0, 0, 0};
  std::vector<uint8_t> filled_;
  int blocks_[3] = {0, 0, 0};
  std::vector<uint8_t> clear_;  ///< per block of cubes: neither it nor a block beside it has a filled cube
};

}  // namespace aligngs
