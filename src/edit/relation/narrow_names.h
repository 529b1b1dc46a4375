// Names that tell the place of a thing: a floor lamp, a bedside table.
#pragma once

#include <string_view>

namespace aligngs {

enum class NarrowPlace { kNone, kOnFloor, kOnFurniture, kAtBed };

/// The place that "floor lamp" or "bedside tables" tells; kNone for other words. Case, articles and plural do not matter.
NarrowPlace narrow_place(std::string_view words);

/// "on the floor", as messages say it.
std::string_view narrow_place_words(NarrowPlace place);

}  // namespace aligngs
