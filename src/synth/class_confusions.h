// ADE20K classes that a segmentation network confuses with others in rooms.
#pragma once

#include <cstdint>
#include <vector>

namespace aligngs {

/// Classes that `label` is commonly confused with, the likeliest first; empty for walls, floor and ceiling, which
/// networks get right.
std::vector<uint16_t> confusable_classes(uint16_t label);

/// Wall, floor, ceiling: one query for all of it rather than one per object.
bool is_stuff(uint16_t label);

}  // namespace aligngs
