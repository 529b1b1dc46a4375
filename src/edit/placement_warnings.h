// Whether an object that was moved or put somewhere floats in the air or reaches into other things.
#pragma once

#include <string>
#include <vector>

#include "edit/apply_edit.h"

namespace aligngs {

/// An object before and after an edit: world positions of its solid Gaussians.
struct Placement {
  std::string name;  ///< as sentences name it, e.g. "armchair#1"
  std::vector<Vec3d> before, after;
  bool original_stays = false;  ///< a copy: the original is a thing like others
};

/// Positions of the solid ones of some rows.
std::vector<Vec3d> solid_places(const GaussianModel& model, const std::vector<uint8_t>& selected);

/// Sentences, each with a move that helps, as `--say` and the page's text box read it. It floats where nothing is within
/// 5 cm under its foot. It collides where it shares at least 6 upright columns of 6 cm with a thing. How it was before
/// counts as its place. Empty without an up direction. `room` is as before the edit, and `selected` marks the rows that
/// move.
std::vector<std::string> placement_warnings(const EditableRoom& room, const std::vector<uint8_t>& selected,
                                            const Placement& placement);

}  // namespace aligngs
