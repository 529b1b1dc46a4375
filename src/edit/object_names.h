// Objects in words, as reports, lists and errors name them.
#pragma once

#include <string>
#include <vector>

#include "gaussians/instances.h"
#include "scene/label_set.h"

namespace aligngs {

/// "pillow#2".
std::string object_name(const Instance& object, const LabelSet& labels);

/// "bed#1, pillow#1, pillow#2"; "nothing that has a name" for an empty list.
std::string objects_text(const std::vector<Instance>& objects, const LabelSet& labels);

/// The first eight: "bed#1, pillow#1, ... and 4 more". Empty for an empty list.
std::string first_objects_text(const std::vector<Instance>& objects, const LabelSet& labels);

}  // namespace aligngs
