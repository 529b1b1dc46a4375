#include "edit/edit_operation.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "edit/edit_change_file.h"
#include "edit/inserted_object.h"
#include "edit/motion_text.h"
#include "io/atomic_file.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchema = 2, kOldestSchema = 1;         // 1: without number and change
constexpr uint64_t kLargestFile = uint64_t(1) << 20;  // bytes
constexpr size_t kMostEdits = 1000;                   // replayed one after the other
constexpr size_t kLongestSelection = 4096;            // bytes, as in selection_text
constexpr size_t kLongestSource = 4096;               // bytes: PATH_MAX of Linux
constexpr const char* kRepair = "put a good copy of the file back, or remove it to forget all edits";

constexpr std::pair<EditKind, const char*> kKinds[] = {
    {EditKind::kDelete, "delete"},       {EditKind::kExtract, "extract"}, {EditKind::kMove, "move"},
    {EditKind::kDuplicate, "duplicate"}, {EditKind::kReplace, "replace"}, {EditKind::kRecolor, "recolor"},
    {EditKind::kHighlight, "highlight"}};

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/// One entry of the file, with errors that name it.
class EntryReader {
 public:
  EntryReader(const Json& json, size_t index, const std::filesystem::path& path)
      : json_(json), index_(index), path_(path) {
    if (!json.is_object()) fail("", "the entry is no object");
  }

  std::string text(const char* key, size_t longest) const {
    const auto it = json_.find(key);
    if (it == json_.end() || !it->is_string()) fail(key, "a text is expected");
    const std::string value = it->get<std::string>();
    if (value.size() > longest) fail(key, "the text is too long");
    return value;
  }
  bool flag(const char* key) const {
    const auto it = json_.find(key);
    if (it == json_.end()) return false;
    if (!it->is_boolean()) fail(key, "true or false is expected");
    return it->get<bool>();
  }
  /// A whole number from 1 on.
  uint32_t number(const char* key) const {
    const auto it = json_.find(key);
    constexpr int64_t kMost = std::numeric_limits<int32_t>::max();
    if (it == json_.end() || !it->is_number_integer() || it->get<int64_t>() < 1 || it->get<int64_t>() > kMost)
      fail(key, "a whole number from 1 on is expected");
    return it->get<uint32_t>();
  }
  bool has(const char* key) const { return json_.contains(key); }
  /// Runs a parser of a user's text; its complaint is one about this file.
  template <class Parse>
  auto parsed(const char* key, Parse&& parse) const {
    try {
      return parse(text(key, 64));
    } catch (const Error& error) {
      fail(key, error.details().message);
    }
  }
  [[noreturn]] void fail(const std::string& key, const std::string& message) const {
    throw_bad_input(path_, "edits[" + std::to_string(index_) + "]" + (key.empty() ? "" : "." + key), message, kRepair);
  }

 private:
  const Json& json_;
  size_t index_;
  const std::filesystem::path& path_;
};

EditOperation parse_entry(const EntryReader& entry) {
  EditOperation edit;
  const std::string name = entry.text("operation", 64);
  bool known = false;
  for (const auto& [kind, kind_name] : kKinds) {
    if (name != kind_name) continue;
    edit.kind = kind;
    known = true;
  }
  if (!known) entry.fail("operation", "delete, extract, move, duplicate, replace, recolor or highlight is expected");
  edit.select = entry.text("select", kLongestSelection);
  if (entry.has("threshold"))
    edit.threshold = entry.parsed("threshold", [](const std::string& t) { return parse_threshold(t); });
  if (takes_color(edit.kind)) edit.color = entry.parsed("color", [](const std::string& t) { return parse_color(t); });
  edit.fill = entry.flag("fill");
  edit.with_contents = entry.flag("with_contents");
  if (entry.has("shift"))
    edit.motion.shift = entry.parsed("shift", [](const std::string& t) { return parse_shift(t); });
  if (edit.kind == EditKind::kReplace) {
    edit.with = entry.text("with", kLongestSource);
    edit.fit = entry.flag("fit");
    edit.up_axis = entry.parsed("up", [](const std::string& t) { return parse_axis(t); });
  }
  if (entry.has("number")) edit.number = entry.number("number");
  if (entry.has("change")) edit.change = entry.text("change", 64);
  if (!edit.change.empty() && (!is_change_name(edit.change) || edit.number == 0))
    entry.fail("change", "the name of a file NNNN-DIGEST.edit and a number are expected");
  if (entry.has("turn")) edit.motion.turn = entry.parsed("turn", [](const std::string& t) { return parse_turn(t); });
  return edit;
}

}  // namespace

bool takes_color(EditKind kind) { return kind == EditKind::kRecolor || kind == EditKind::kHighlight; }

bool leaves_hole(EditKind kind) {
  return kind == EditKind::kDelete || kind == EditKind::kMove || kind == EditKind::kReplace;
}

std::string edit_kind_name(EditKind kind) {
  for (const auto& [known, name] : kKinds) {
    if (known == kind) return name;
  }
  return "";
}

std::array<uint8_t, 3> parse_color(std::string_view text) {
  const bool brief = text.size() == 4, full = text.size() == 7;
  std::array<uint8_t, 3> color{};
  bool good = (brief || full) && text[0] == '#';
  for (size_t c = 0; good && c < 3; ++c) {
    const int high = hex_digit(text[brief ? 1 + c : 1 + 2 * c]), low = hex_digit(text[brief ? 1 + c : 2 + 2 * c]);
    good = high >= 0 && low >= 0;
    color[c] = static_cast<uint8_t>(16 * high + low);
  }
  if (!good)
    throw_usage("\"" + std::string(text.substr(0, 40)) + "\" is no colour",
                "write it as '#rrggbb', for example '#add8e6'");
  return color;
}

std::string color_text(const std::array<uint8_t, 3>& color) {
  return fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]);
}

std::string describe(const EditOperation& edit) {
  const bool turns = edit.kind == EditKind::kMove && edit.motion.stays_in_place() && edit.motion.turn != 0;
  std::string text = (turns ? "turn" : edit_kind_name(edit.kind)) + " " + edit.select;
  if (edit.kind == EditKind::kRecolor) text += " to " + color_text(edit.color);
  if (edit.kind == EditKind::kHighlight) text += " in " + color_text(edit.color);
  if (edit.threshold.kind != ThresholdRule::Kind::kArgmax)
    text += " (threshold " + threshold_text(edit.threshold) + ")";
  if (edit.with_contents) text += kWithContents;
  if (turns) {
    text += fmt::format(" by {:.9g}", edit.motion.turn);
  } else if (edit.kind == EditKind::kMove || edit.kind == EditKind::kDuplicate) {
    text += motion_text(edit.motion);
  }
  if (edit.kind == EditKind::kReplace) {
    text += " with " + edit.with;
    if (edit.fit) text += kFitted;
    if (edit.up_axis != UpAxis::kZ) text += fmt::format("{}{}", kUpwards, word_of(edit.up_axis));
    if (edit.motion.turn != 0) text += fmt::format("{}{:.9g}", kAndTurn, edit.motion.turn);
  }
  if (edit.kind == EditKind::kDelete && edit.fill) text += kHoleFilled;
  if (leaves_hole(edit.kind) && !edit.fill) text += kHoleLeftOpen;
  return text;
}

std::string describe(const std::vector<EditOperation>& edits) {
  std::string text;
  for (const EditOperation& edit : edits) text += (text.empty() ? "" : "; ") + describe(edit);
  return text;
}

std::vector<EditOperation> parse_edits(const std::string& json, const std::filesystem::path& name_for_errors) {
  const auto refuse = [&](const char* field, const char* message) {
    throw_bad_input(name_for_errors, field, message, kRepair);
  };
  // Depth is bounded before parsing: the parser recurses when it destroys what it read.
  constexpr int kDeepest = 16;
  int depth = 0;
  for (const char c : json) {
    depth += (c == '{' || c == '[') - (c == '}' || c == ']');
    if (depth > kDeepest) refuse("", "nested too deeply for a list of edits");
  }
  const Json document = parse_ordered_json(json);
  if (!document.is_object()) refuse("", "this is no JSON object");
  const auto schema = document.find("schema");
  if (schema == document.end() || !schema->is_number_integer() || schema->get<int64_t>() < kOldestSchema ||
      schema->get<int64_t>() > kSchema) {
    refuse("schema", "schema 1 or 2 is expected");
  }
  const auto list = document.find("edits");
  if (list == document.end() || !list->is_array()) refuse("edits", "a list is expected");
  if (list->size() > kMostEdits) refuse("edits", "more than 1000 edits");
  std::vector<EditOperation> edits;
  for (const Json& entry : *list) {
    const EntryReader reader(entry, edits.size(), name_for_errors);
    EditOperation edit = parse_entry(reader);
    if (edit.number != 0 && !edits.empty() && edit.number <= edits.back().number)
      reader.fail("number", "the numbers of edits rise");
    edits.push_back(std::move(edit));
  }
  return edits;
}

Json edits_json(const std::vector<EditOperation>& edits) {
  Json list = Json::array();
  for (const EditOperation& edit : edits) {
    Json entry = {{"operation", edit_kind_name(edit.kind)},
                  {"select", edit.select},
                  {"threshold", threshold_text(edit.threshold)}};
    if (takes_color(edit.kind)) entry["color"] = color_text(edit.color);
    if (leaves_hole(edit.kind)) entry["fill"] = edit.fill;
    if (edit.kind == EditKind::kReplace) {
      entry["with"] = edit.with;
      entry["fit"] = edit.fit;
      entry["up"] = word_of(edit.up_axis);
      entry["turn"] = fmt::format("{:.9g}", edit.motion.turn);
    }
    if (edit.kind == EditKind::kMove || edit.kind == EditKind::kDuplicate) {
      const Vec3d& s = edit.motion.shift;
      entry["shift"] = fmt::format("{:.9g},{:.9g},{:.9g}", s.x, s.y, s.z);
      entry["turn"] = fmt::format("{:.9g}", edit.motion.turn);
    }
    if (edit.with_contents) entry["with_contents"] = true;
    list.push_back(entry);
  }
  return list;
}

std::string edits_text(const std::vector<EditOperation>& edits) {
  Json list = edits_json(edits);
  for (size_t i = 0; i < edits.size(); ++i) {
    if (edits[i].number != 0) list[i]["number"] = edits[i].number;
    if (!edits[i].change.empty()) list[i]["change"] = edits[i].change;
  }
  return json_document(Json{{"schema", kSchema}, {"edits", list}});
}

std::vector<EditOperation> read_edits(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return {};
  return parse_edits(read_file(path, kLargestFile), path);
}

}  // namespace aligngs
