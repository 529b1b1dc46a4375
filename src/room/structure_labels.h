// Labels of walls, floor and ceiling for pixels, from planes alone.
#pragma once

#include "room/room_structure.h"
#include "scene/label_set.h"

namespace aligngs {

/// Classes of a pixel: wall, floor, ceiling, something else, and what is seen through a window or doorway.
enum class StructureLabel : uint16_t { kWall, kFloor, kCeiling, kOther, kBeyond };

/// Their names, which room_classes() knows.
const LabelSet& structure_label_set();

/// A StructureLabel per pixel with depth, kNoLabel for the others.
Image<uint16_t> structure_labels(const MeasuredView& view, const RoomStructure& structure,
                                 const RoomStructureSettings& settings = {});

}  // namespace aligngs
