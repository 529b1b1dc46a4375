// Things that belong to another one of another class: the pot of a plant.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "edit/selection.h"
#include "scene/label_set.h"

namespace aligngs {

/// Lengths are shares of the extent, which is about 3 m in a room.
struct ObjectPartSettings {
  double contact = 0.02;      ///< Gaussians this near touch (6 cm): leaves begin a little above the earth
  size_t least_touching = 5;  ///< Gaussians of a part that touch
  double most = 0.5;          ///< a thing of which this share is selected needs no rule
};

/// Pots and vases that are under selected plants, flowers and trees and touch them. Whoever takes a plant away
/// takes its pot along; who takes the pot alone leaves the plant. A plant of which less than half is selected is no
/// selected plant. Without `up` it is not asked which is below. Empty
/// without labels.
std::vector<Instance> parts_of(const LabelledGaussians& room, const std::vector<uint8_t>& selected,
                               const LabelSet& labels, const std::optional<Vec3d>& up,
                               const ObjectPartSettings& settings = {});

}  // namespace aligngs
