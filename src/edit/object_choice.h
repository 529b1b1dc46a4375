// "the largest chair", "the left pillow": the number of the object that is meant.
#pragma once

#include <optional>
#include <vector>

#include "edit/selection_text.h"
#include "gaussians/instances.h"

namespace aligngs {

/// Directions that "left" and "highest" need.
struct Viewpoint {
  std::optional<Vec3d> up;     ///< unit, world
  std::optional<Vec3d> place;  ///< world; the mean place of the photos' cameras
};

/// The query with numbers in place of choices. Largest and smallest compare the volume of the boxes around the
/// objects, and highest and lowest their middles. Left and right are as a person sees who is at the mean place of the
/// cameras and looks at the objects of that class. Error{kBadInput} when the room has no such object, or when a
/// direction is not known.
SelectionQuery with_numbers(SelectionQuery query, const std::vector<Instance>& objects, const Viewpoint& viewpoint,
                            const LabelSet& labels);

}  // namespace aligngs
