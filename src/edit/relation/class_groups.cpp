#include "edit/relation/class_groups.h"

#include <algorithm>
#include <string>

#include "edit/vocabulary.h"

namespace aligngs {
namespace {

struct KnownWord {
  std::string_view word;
  ClassGroup group;
  bool one = false, needs_place = false;
};

constexpr KnownWord kGroupWords[] = {{"furniture", ClassGroup::kFurniture, false},
                                     {"furnishings", ClassGroup::kFurniture, false},
                                     {"pieces of furniture", ClassGroup::kFurniture, false},
                                     {"piece of furniture", ClassGroup::kFurniture, true},
                                     {"seating", ClassGroup::kSeating, false},
                                     {"seating furniture", ClassGroup::kSeating, false},
                                     {"things", ClassGroup::kThings, false},
                                     {"objects", ClassGroup::kThings, false},
                                     {"items", ClassGroup::kThings, false},
                                     {"stuff", ClassGroup::kThings, false},
                                     {"everything", ClassGroup::kThings, false, true},
                                     {"anything", ClassGroup::kThings, false, true},
                                     {"all", ClassGroup::kThings, false, true},
                                     {"what", ClassGroup::kThings, false, true},
                                     {"whatever", ClassGroup::kThings, false, true},
                                     {"thing", ClassGroup::kThings, true},
                                     {"object", ClassGroup::kThings, true},
                                     {"item", ClassGroup::kThings, true}};

/// Fixtures such as a sink, and things of a hand's size, are no furniture.
constexpr std::string_view kMovable[] = {"bed",          "cradle",  "sofa",       "chair",          "armchair",
                                         "swivel chair", "stool",   "ottoman",    "bench",          "seat",
                                         "table",        "desk",    "pool table", "kitchen island", "coffee table",
                                         "buffet",       "cabinet", "wardrobe",   "bookcase",       "chest of drawers",
                                         "shelf",        "counter"};
constexpr std::string_view kSeats[] = {"sofa",  "chair",   "armchair", "swivel chair",
                                       "stool", "ottoman", "bench",    "seat"};
constexpr std::string_view kFixtures[] = {"door",   "screen door", "windowpane", "stairs",  "stairway", "step",
                                          "column", "escalator",   "bannister",  "railing", "fireplace"};
constexpr std::string_view kHung[] = {"curtain", "blind", "radiator", "awning", "hood"};
constexpr std::string_view kShell[] = {"wall", "floor", "ceiling"};
/// Furniture that hangs on no wall, and rests on no other furniture.
constexpr std::string_view kHeavy[] = {"bed",          "cradle",  "sofa",       "chair",           "armchair",
                                       "swivel chair", "stool",   "ottoman",    "bench",           "seat",
                                       "table",        "desk",    "pool table", "kitchen island",  "coffee table",
                                       "wardrobe",     "bathtub", "toilet",     "chest of drawers"};
/// Things that rest on the floor where they reach down to it, and may hang elsewhere.
constexpr std::string_view kStanding[] = {
    "cabinet", "bookcase", "buffet", "counter", "refrigerator", "stove", "washer", "dishwasher", "case", "plant",
    "palm",    "tree",     "box",    "basket",  "ashcan",       "pot",   "fan",    "lamp",       "bag"};
/// Furniture with doors, drawers or boards: a thing on its top is not in it.
constexpr std::string_view kClosed[] = {"wardrobe",  "cabinet", "chest of drawers", "bookcase",
                                        "case",      "buffet",  "refrigerator",     "oven",
                                        "microwave", "stove",   "washer",           "dishwasher"};
constexpr std::string_view kPotted[] = {"plant", "flower", "palm", "tree"};
constexpr std::string_view kPots[] = {"pot", "vase", "basket"};

template <class Names>
bool holds_name(const Names& names, std::string_view name) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

}  // namespace

std::optional<GroupWord> find_group(std::string_view words) {
  const std::string folded = without_article(folded_name(words));
  for (const KnownWord& known : kGroupWords) {
    if (known.word == folded) return GroupWord{known.group, known.one, known.needs_place};
  }
  return std::nullopt;
}

std::string_view group_name(ClassGroup group) {
  if (group == ClassGroup::kFurniture) return "furniture";
  return group == ClassGroup::kSeating ? "seating" : "things";
}

bool is_fixture(const LabelSet& labels, int label) {
  return holds_name(kFixtures, labels.classes.at(static_cast<size_t>(label)).name);
}

bool never_stands(const LabelSet& labels, int label) {
  return is_fixture(labels, label) || holds_name(kHung, labels.classes.at(static_cast<size_t>(label)).name);
}

bool is_heavy(const LabelSet& labels, int label) {
  return holds_name(kHeavy, labels.classes.at(static_cast<size_t>(label)).name);
}

bool is_standing(const LabelSet& labels, int label) {
  return is_heavy(labels, label) || holds_name(kStanding, labels.classes.at(static_cast<size_t>(label)).name);
}

bool is_closed(const LabelSet& labels, int label) {
  return holds_name(kClosed, labels.classes.at(static_cast<size_t>(label)).name);
}

bool may_stand_in(const LabelSet& labels, int label, int pot) {
  return holds_name(kPotted, labels.classes.at(static_cast<size_t>(label)).name) &&
         holds_name(kPots, labels.classes.at(static_cast<size_t>(pot)).name);
}

bool is_of_group(const LabelSet& labels, int label, ClassGroup group) {
  const std::string& name = labels.classes.at(static_cast<size_t>(label)).name;
  if (group == ClassGroup::kFurniture) return holds_name(kMovable, name);
  if (group == ClassGroup::kSeating) return holds_name(kSeats, name);
  return group == ClassGroup::kThings && !holds_name(kShell, name);
}

}  // namespace aligngs
