// One edit: what is done to which objects. The same record serves the command line, edits.json and the page.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "edit/object_motion.h"
#include "edit/selection_text.h"
#include "edit/up_axis.h"

namespace aligngs {

struct InsertedObject;

enum class EditKind {
  kDelete,     ///< the selected objects are gone
  kExtract,    ///< everything else is gone
  kMove,       ///< the selected objects are at another place; what they hid continues there
  kDuplicate,  ///< a copy of the selected objects is at another place
  kReplace,    ///< the selected objects are gone, and an object from elsewhere is there
  kRecolor,    ///< the selected objects have the colour in the mean; light and texture stay
  kHighlight   ///< the selected objects are mixed with the colour
};

struct EditOperation {
  EditKind kind = EditKind::kDelete;
  std::string select;  ///< selection text (selection_text.h)
  ThresholdRule threshold;
  std::array<uint8_t, 3> color{255, 200, 0};  ///< sRGB, of kRecolor and kHighlight
  bool fill = false;            ///< kDelete, kMove, kReplace: continue the surfaces behind and under the object
  bool with_contents = false;   ///< also things on the selected objects; not for colours
  ObjectMotion motion;          ///< kMove, kDuplicate; a copy that has none is beside the original
  std::string with;             ///< kReplace: where the other object comes from (inserted_object.h)
  UpAxis up_axis = UpAxis::kZ;  ///< kReplace: upwards in a file of splats
  bool fit = false;             ///< kReplace: scale the other object to the box of the selection
  std::shared_ptr<const InsertedObject> object;  ///< kReplace: what `with` names, once it has been read
  uint32_t number = 0;  ///< in its run, from 1 on, never the same for two edits of a stack; 0: has none yet
  /// file in RUN/edits/ with what the edit did (edit_change_file.h); empty: only the words are known
  std::string change;
};

/// Ends of descriptions.
inline constexpr std::string_view kWithContents = " with contents";
inline constexpr std::string_view kHoleFilled = ", hole filled", kHoleLeftOpen = ", hole left open";
inline constexpr std::string_view kFitted = ", fitted", kUpwards = ", up ", kAndTurn = " and turn by ";

bool takes_color(EditKind kind);            ///< recolor and highlight
bool leaves_hole(EditKind kind);            ///< delete, move and replace
std::string edit_kind_name(EditKind kind);  ///< "delete", "extract", "move", "duplicate", "replace", "recolor", ...
/// "#rrggbb" or "#rgb"; Error{kUsage} for anything else.
std::array<uint8_t, 3> parse_color(std::string_view text);
std::string color_text(const std::array<uint8_t, 3>& color);    ///< "#rrggbb"
std::string describe(const EditOperation& edit);                ///< "recolor pillow to #add8e6", for lists and messages
std::string describe(const std::vector<EditOperation>& edits);  ///< the same of several, with "; " between

/// edits.json: the stack of a run, oldest first. Schema 1 is of earlier programs and has no changes. Error{kBadInput}
/// naming entry and field; selections are only checked
/// against a label set when they are applied.
std::vector<EditOperation> parse_edits(const std::string& json, const std::filesystem::path& name_for_errors);
std::string edits_text(const std::vector<EditOperation>& edits);
/// Their words as an array, without number and change: for the record of a run of its own.
nlohmann::ordered_json edits_json(const std::vector<EditOperation>& edits);
/// An absent file is an empty stack.
std::vector<EditOperation> read_edits(const std::filesystem::path& path);

}  // namespace aligngs
