// The text that says which objects are meant: "pillow, cushion#2", "everything but wall, floor".
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "edit/selection_words.h"
#include "edit/vocabulary.h"

namespace aligngs {

/// One class, one object of it, or a selection that was drawn by hand.
struct SelectionTerm {
  int label = 0;     ///< class number; -1 with `named`
  int instance = 0;  ///< 1, 2, ... as in scene.labels.ply, largest object first; 0 = all objects of the class
  ObjectChoice choice = ObjectChoice::kNone;  ///< instead of a number, until object_choice.h finds the number
  std::string named{};                        ///< name of a selection (named_selection.h)
  /// of `named`: one flag per Gaussian of the room, once room_selections.h has found them
  std::shared_ptr<const std::vector<uint8_t>> rows{};
};

struct SelectionQuery {
  bool everything = false;             ///< also what has no label
  std::vector<SelectionTerm> include;  ///< united
  std::vector<SelectionTerm> exclude;  ///< taken away afterwards
};

/// Grammar: items parted by commas (or "and", "or", "&"). An item is a name, optionally with "#" and object numbers
/// ("bed#2", "bed#1-3", "bed 2", "the second bed"). "All", "every" or "the" may precede it. "Largest", "smallest",
/// "left", "right", "highest" or "lowest" before it choose one object. "#2" alone is of the name before it, and so is
/// "2" after a number. "everything" or "all" is the whole room; after "but", "except", "apart from" or the like are the
/// exclusions. An item that is the name of a
/// selection (Vocabulary::add_selection) means that selection.
/// Error{kUsage} for empty text, unknown names (with suggestions), and bad object numbers.
SelectionQuery parse_selection(std::string_view text, const Vocabulary& vocabulary);

/// The same selection in one spelling, for edits.json and messages; parse_selection reads it back.
std::string selection_text(const SelectionQuery& query, const LabelSet& labels);

/// How sure a Gaussian must be to be selected.
struct ThresholdRule {
  enum class Kind {
    kArgmax,  ///< the class is the Gaussian's most probable one
    kAuto,    ///< its probability is above the split of the class's histogram (Otsu 1979)
    kValue    ///< the probability of the named classes together is at least `value`
  };
  Kind kind = Kind::kArgmax;
  double value = 0;  ///< in (0, 1], for kValue
};

/// "argmax", "auto" or a number in (0, 1]; Error{kUsage} for anything else.
ThresholdRule parse_threshold(std::string_view text);
std::string threshold_text(const ThresholdRule& rule);

}  // namespace aligngs
