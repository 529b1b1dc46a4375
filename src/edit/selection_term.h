// One item of a selection: a class, an object of it, a group of classes, or a selection that was drawn by hand.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "edit/relation/class_groups.h"
#include "edit/relation/narrow_names.h"
#include "edit/relation/relation_words.h"
#include "edit/selection_words.h"

namespace aligngs {

struct RelatedTo;

struct SelectionTerm {
  int label = 0;     ///< class number; -1 with `named` and `group`
  int instance = 0;  ///< 1, 2, ... as in scene.labels.ply, largest object first; 0 = all objects of the class
  ObjectChoice choice = ObjectChoice::kNone;  ///< instead of a number, until meant_objects.h finds the number
  int rank = 1;                               ///< among `choice`: 2 of "the second largest"
  std::string named{};                        ///< name of a selection (named_selection.h)
  /// of `named`: one flag per Gaussian of the room, once room_selections.h has found them
  std::shared_ptr<const std::vector<uint8_t>> rows{};
  // The following are gone when meant_objects.h has found the objects.
  ClassGroup group = ClassGroup::kNone;  ///< "all furniture"
  int count = 0;  ///< objects that are meant: 2 of "both pillows" and "the two largest"; 0: any number
  std::shared_ptr<const RelatedTo> relation{};  ///< "on the bed"; null: anywhere
  std::string color{};                          ///< "red" of "the red chair" (relation/color_words.h)
  int among = 0;                            ///< "the largest of the two lamps": there must be so many; 0: any number
  NarrowPlace narrow = NarrowPlace::kNone;  ///< of "floor lamp"

  /// Whether the objects of the room tell what is meant.
  bool asks_objects() const {
    return choice != ObjectChoice::kNone || group != ClassGroup::kNone || count > 0 || relation || !color.empty() ||
           narrow != NarrowPlace::kNone;
  }
};

/// Place of the objects of a term.
struct RelatedTo {
  Relation relation = Relation::kOn;
  std::vector<SelectionTerm> anchors;  ///< "the bed", "bed#1-2": objects of one class or group
  /// "the window" of "between the bed and the window"; empty of "between the beds"
  std::vector<SelectionTerm> other_side{};
  bool any_anchor = false;  ///< "on the beds": not all of them are on one bed
  bool negated = false;     ///< "not on the bed"
  /// "on the wall" of "on the wall above the bed": the objects are in both places; null: in the one place
  std::shared_ptr<const RelatedTo> also{};
};

}  // namespace aligngs
