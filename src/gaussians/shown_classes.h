// The classes that a picture of labels can show at all: often a tenth of those that there are.
#pragma once

#include <cstdint>
#include <vector>

#include "gaussians/gaussian_model.h"

namespace aligngs {

/// Drops the semantic columns of classes that no label picture shows, and returns the class of each column that is
/// left. It is for rows whose softmax is blended (SemanticBlend::kProbabilities). A class is dropped where no row gives
/// it more than a millionth. Rows that are the same for all classes give no class more than another, and do not count.
/// Class 0 stays, as pixels of such rows alone have it. Without semantics the list is empty.
std::vector<uint16_t> keep_shown_classes(GaussianModel& model);

}  // namespace aligngs
