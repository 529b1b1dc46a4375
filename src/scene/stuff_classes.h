// Classes that are no single things.
#pragma once

#include <vector>

namespace aligngs {

/// ADE20K's numbers: wall, floor, ceiling and 47 others. All of such a class in a photo is one segment.
const std::vector<int>& ade20k_stuff_classes();

}  // namespace aligngs
