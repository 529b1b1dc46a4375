// Things that an object carries: a vase and books on a chest of drawers, pillows on a bed.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/selection.h"
#include "scene/label_set.h"

namespace aligngs {

/// Lengths are shares of the extent, which is about 3 m in a room.
struct ContentsSettings {
  double column = 0.02;   ///< edge of the columns in which heights are compared (6 cm)
  double contact = 0.03;  ///< gap below which a thing rests on another (9 cm)
  double share = 0.5;     ///< of the columns of a thing that must have the object right below it
};

/// Objects that rest on the selected Gaussians, and those that rest on these. Walls, floor, ceiling, rugs,
/// doors, windows and what hangs rest on nothing. Empty without an up direction. Objects of which most is selected are
/// left out.
std::vector<Instance> contents_of(const LabelledGaussians& room, const std::vector<uint8_t>& selected,
                                  const LabelSet& labels, const Vec3d& up, const ContentsSettings& settings = {});

/// Adds the rows of objects to a selection.
void select_objects(const LabelledGaussians& room, const std::vector<Instance>& objects,
                    std::vector<uint8_t>& selected);

}  // namespace aligngs
