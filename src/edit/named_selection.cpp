#include "edit/named_selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "edit/vocabulary.h"
#include "io/atomic_file.h"
#include "io/json_text.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int kSelectionsSchema = 1;
constexpr uint64_t kLargestSelections = uint64_t(64) << 20;  // bytes; a selection of a room has some ten kilobytes
constexpr size_t kLongestName = 64;                          // bytes
constexpr uint32_t kMostGaussians = std::numeric_limits<int32_t>::max();  // rows of a scene
constexpr int kSelectionsDepth = 8;                                       // brackets in brackets; the format has three
constexpr const char* kForget = "remove selections.json to forget all selections that were drawn by hand";

/// One entry of the file, with errors that name it.
class SelectionEntry {
 public:
  SelectionEntry(const Json& json, size_t index, const fs::path& path) : json_(json), index_(index), path_(path) {
    if (!json.is_object()) fail("", "the entry is no object");
  }
  const std::string& text(const char* key) const {
    const auto it = json_.find(key);
    if (it == json_.end() || !it->is_string()) fail(key, "a text is expected");
    return it->get_ref<const std::string&>();
  }
  uint32_t number(const char* key) const {
    const auto it = json_.find(key);
    if (it == json_.end() || !it->is_number_integer() || it->get<int64_t>() < 1 || it->get<int64_t>() > kMostGaussians)
      fail(key, "a whole number from 1 on is expected");
    return it->get<uint32_t>();
  }
  uint64_t digest(const char* key) const {
    const std::string& hex = text(key);
    uint64_t value = 0;
    const auto [end, error] = std::from_chars(hex.data(), hex.data() + hex.size(), value, 16);
    if (hex.size() != 16 || error != std::errc() || end != hex.data() + hex.size())
      fail(key, "16 hexadecimal digits are expected");
    return value;
  }
  [[noreturn]] void fail(const std::string& key, const std::string& message) const {
    throw_bad_input(path_, "selections[" + std::to_string(index_) + "]" + (key.empty() ? "" : "." + key), message,
                    kForget);
  }

 private:
  const Json& json_;
  size_t index_;
  const fs::path& path_;
};

/// "12-41,57" as ranges.
std::vector<RowRange> parse_rows(const SelectionEntry& entry, uint32_t gaussians) {
  const std::string& text = entry.text("rows");
  std::vector<RowRange> ranges;
  const char *at = text.data(), *const end = at + text.size();
  const auto number = [&] {
    uint32_t value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc()) entry.fail("rows", "rows as \"12-41,57\" are expected");
    if (value >= gaussians) entry.fail("rows", fmt::format("the scene has no row {}", value));
    at = next;
    return value;
  };
  uint32_t free = 0;  // the first row that may follow
  for (bool more = true; more;) {
    const uint32_t first = number();
    uint32_t last = first;
    if (at != end && *at == '-') {
      ++at;
      last = number();
    }
    if (last < first || first < free) entry.fail("rows", "the rows do not ascend with a gap between two ranges");
    ranges.push_back({first, last - first + 1});
    free = last + 2;
    more = at != end;
    if (more && *at++ != ',') entry.fail("rows", "rows as \"12-41,57\" are expected");
  }
  return ranges;
}

NamedSelection parse_selection_entry(const SelectionEntry& entry) {
  NamedSelection out;
  try {
    out.name = selection_name(entry.text("name"));
  } catch (const Error& error) {
    entry.fail("name", error.details().message);
  }
  if (out.name != entry.text("name")) entry.fail("name", "the name has blanks that no name has");
  out.scene = entry.digest("scene");
  out.gaussians = entry.number("gaussians");
  out.ranges = parse_rows(entry, out.gaussians);
  return out;
}

std::string rows_text(const std::vector<RowRange>& ranges) {
  std::string text;
  for (const RowRange& range : ranges) {
    if (!text.empty()) text += ',';
    text += std::to_string(range.first);
    if (range.count > 1) text += "-" + std::to_string(range.first + range.count - 1);
  }
  return text;
}

bool is_letter(unsigned char c) {
  constexpr unsigned char kOtherLanguages = 0x80;  // first byte of a letter beyond ASCII in UTF-8
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c >= kOtherLanguages;
}

}  // namespace

size_t NamedSelection::count() const {
  size_t sum = 0;
  for (const RowRange& range : ranges) sum += range.count;
  return sum;
}

std::vector<uint8_t> NamedSelection::mask() const {
  std::vector<uint8_t> out(gaussians, 0);
  for (const RowRange& range : ranges) std::fill_n(out.begin() + range.first, range.count, uint8_t(1));
  return out;
}

bool NamedSelection::is_called(std::string_view other) const { return folded_name(name) == folded_name(other); }

void NamedSelection::set_rows(const std::vector<uint8_t>& flags) {
  gaussians = static_cast<uint32_t>(flags.size());
  ranges.clear();
  for (uint32_t i = 0; i < flags.size(); ++i) {
    if (!flags[i]) continue;
    if (i > 0 && flags[i - 1])
      ++ranges.back().count;
    else
      ranges.push_back({i, 1});
  }
}

std::string selection_name(std::string_view given) {
  std::string name;
  bool has_letter = false;
  constexpr std::string_view kSigns = "0123456789-_.'";
  for (const char c : given.substr(0, 2 * kLongestName)) {
    const bool letter = is_letter(static_cast<unsigned char>(c));
    has_letter |= letter;
    if (c == ' ') {
      if (!name.empty() && name.back() != ' ') name += c;
    } else if (letter || kSigns.find(c) != std::string_view::npos) {
      name += c;
    } else {
      throw_usage("the name of a selection holds a sign that no edit could speak of",
                  "use letters, digits, blanks and - _ . '");
    }
  }
  if (!name.empty() && name.back() == ' ') name.pop_back();
  if (!has_letter) throw_usage("the name of a selection has no letter", "for example \"my corner\"");
  if (name.size() > kLongestName || given.size() > 2 * kLongestName)
    throw_usage("the name of a selection is longer than 64 bytes", "choose a shorter one");
  if (parse_json(json_line(nlohmann::json(name))) != nlohmann::json(name))
    throw_usage("the name of a selection is no UTF-8", "type it in a terminal that uses UTF-8");
  return name;
}

std::vector<NamedSelection> parse_named_selections(const std::string& json, const fs::path& name_for_errors) {
  const auto refuse = [&](const char* field, const char* message) {
    throw_bad_input(name_for_errors, field, message, kForget);
  };
  int depth = 0;  // bounded before parsing: the parser recurses when it destroys what it read
  for (const char c : json) {
    depth += (c == '{' || c == '[') - (c == '}' || c == ']');
    if (depth > kSelectionsDepth) refuse("", "nested too deeply for a list of selections");
  }
  const Json document = parse_ordered_json(json);
  if (!document.is_object()) refuse("", "this is no JSON object");
  const auto schema = document.find("schema");
  if (schema == document.end() || !schema->is_number_integer() || schema->get<int64_t>() != kSelectionsSchema)
    refuse("schema", "schema 1 is expected");
  const auto list = document.find("selections");
  if (list == document.end() || !list->is_array()) refuse("selections", "a list is expected");
  if (list->size() > kMostNamedSelections) refuse("selections", "more than 256 selections");
  std::vector<NamedSelection> out;
  for (const Json& json_entry : *list) {
    const SelectionEntry entry(json_entry, out.size(), name_for_errors);
    NamedSelection selection = parse_selection_entry(entry);
    for (const NamedSelection& before : out) {
      if (before.is_called(selection.name)) entry.fail("name", "two selections have this name");
    }
    out.push_back(std::move(selection));
  }
  return out;
}

std::string named_selections_text(const std::vector<NamedSelection>& selections) {
  Json list = Json::array();
  for (const NamedSelection& s : selections) {
    list.push_back({{"name", s.name},
                    {"scene", fmt::format("{:016x}", s.scene)},
                    {"gaussians", s.gaussians},
                    {"rows", rows_text(s.ranges)}});
  }
  return json_document(Json{{"schema", kSelectionsSchema}, {"selections", list}});
}

std::vector<NamedSelection> read_named_selections(const fs::path& path) {
  if (!fs::exists(path)) return {};
  return parse_named_selections(read_file(path, kLargestSelections), path);
}

fs::path named_selections_file(const fs::path& run) { return run / "selections.json"; }

}  // namespace aligngs
