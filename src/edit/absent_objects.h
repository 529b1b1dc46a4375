// Things that a selection names and the room lacks, and those that the room has instead.
#pragma once

#include <string>
#include <vector>

#include "edit/selection.h"
#include "edit/selection_text.h"

namespace aligngs {

/// Names of a selection, also those after "but", of which the room has no object: "sofa", "bed#9". Groups of classes
/// and selections by hand are none of them.
std::vector<std::string> absent_names(const std::vector<Instance>& objects, const SelectionQuery& query,
                                      const LabelSet& labels);

/// Remedy of an error about a thing that the room lacks. It names objects of its class, else those of its kin
/// (class_kin.h), else the first ones of the room.
std::string held_instead(const std::vector<Instance>& objects, const std::vector<SelectionTerm>& wanted,
                         const LabelSet& labels);

}  // namespace aligngs
