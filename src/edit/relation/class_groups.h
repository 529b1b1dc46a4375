// Words for many classes at once: "furniture", "seating", "everything" on a table.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "scene/label_set.h"

namespace aligngs {

enum class ClassGroup { kNone, kThings, kFurniture, kSeating };

/// A word for a group, as a person says it.
struct GroupWord {
  ClassGroup group = ClassGroup::kNone;
  bool one = false;          ///< "the thing on the table", "a piece of furniture": one object is meant
  bool needs_place = false;  ///< "everything" by itself is the whole room
};

/// "furniture", "things", "everything"; articles and case do not matter. Nothing for other words.
std::optional<GroupWord> find_group(std::string_view words);

/// "furniture", "seating" or "things".
std::string_view group_name(ClassGroup group);

/// Whether a class is a part of the house: a door, a window, stairs. "Everything on the floor" is without these.
bool is_fixture(const LabelSet& labels, int label);

/// Whether things of a class hang or are fixed, even where they reach down to the floor: fixtures, curtains, radiators.
bool never_stands(const LabelSet& labels, int label);

/// Whether things of a class neither hang nor rest on furniture: a bed, a sofa, a table.
bool is_heavy(const LabelSet& labels, int label);

/// Whether things of a class rest on the floor where they nearly reach down to it: heavy ones, cabinets, plants, boxes.
bool is_standing(const LabelSet& labels, int label);

/// Whether things are inside of a class or on its top, and on its top they are not in it: a wardrobe.
bool is_closed(const LabelSet& labels, int label);

/// Whether a thing of one class has its place in a thing of the other: a plant in its pot.
bool may_stand_in(const LabelSet& labels, int label, int pot);

/// Whether a class is of the group. Things are all classes but walls, floor and ceiling.
bool is_of_group(const LabelSet& labels, int label, ClassGroup group);

}  // namespace aligngs
