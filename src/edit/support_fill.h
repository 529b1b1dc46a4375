// The furniture that carried a deleted object: its plane under the object, and the one behind.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "edit/selection.h"

namespace aligngs {

struct SupportOptions {
  double link = 0.03;        ///< / extent: nearer Gaussians are of one part (10 cm in a room)
  double ring = 0.06;        ///< / extent: Gaussians this near to the selection are its surroundings (20 cm)
  double tolerance = 0.008;  ///< / extent: distance from the plane within which a Gaussian lies on it (3 cm)
  int trials = 400;          ///< of the random sample consensus (Fischler and Bolles 1981)
  uint64_t seed = 1;
};

/// The plane normal . x = offset; the deleted object lies on the side that the normal points to.
struct SupportPlane {
  Vec3d normal;
  double offset = 0;
  std::vector<uint32_t> carriers;  ///< rows of the surrounding Gaussians that lie on it
};

/// The selection in connected parts: separate things have supporting planes of their own. One mask per part, the part
/// with the smallest row first; parts of fewer than 20 Gaussians leave no hole worth filling.
std::vector<std::vector<uint8_t>> connected_parts(const LabelledGaussians& room, const std::vector<uint8_t>& selected,
                                                  const SupportOptions& options = {});

/// The plane with most of the surroundings on it and the object on one side; with `up`, planes under the object count
/// up to twice. Then, if there is one at more than 66 degrees to it, the plane that the object leaned on. A pillow
/// rests on a bed and leans on its headboard. Empty when the surroundings have no plane. `part` is one part of the
/// `selected` Gaussians, all of which go; `candidates` marks the rows that may carry.
std::vector<SupportPlane> find_supports(const LabelledGaussians& room, const std::vector<uint8_t>& part,
                                        const std::vector<uint8_t>& selected, const std::vector<uint8_t>& candidates,
                                        const std::optional<Vec3d>& up, const SupportOptions& options = {});

}  // namespace aligngs
