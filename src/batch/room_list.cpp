#include "batch/room_list.h"

#include <algorithm>
#include <array>

#include "batch/option_words.h"
#include "core/error.h"
#include "core/letter_case.h"
#include "io/atomic_file.h"
#include "io/text_encoding.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kLargestRoomList = uint64_t(16) << 20;  // bytes: 100 for each of 160 000 rooms
constexpr size_t kLongestName = 100;  // characters: with the suffixes of leases and logs below the 255 of file systems
const char* const kLineForm = "a line is: room <TAB> source <TAB> options";

/// The batch decides about these.
constexpr std::array<const char*, 10> kOwnOptions = {"--dry-run",   "--output", "--resume", "--overwrite", "--view",
                                                     "--view-port", "--json",   "--quiet",  "--help",      "--version"};
constexpr const char* kOwnLetters = "oqh";  // their short forms

bool is_own(const std::string& word) {
  if (word.size() > 1 && word[0] == '-' && std::string_view(kOwnLetters).find(word[1]) != std::string_view::npos)
    return true;
  return std::any_of(kOwnOptions.begin(), kOwnOptions.end(), [&](const char* own) { return has_option({word}, own); });
}

std::vector<std::string_view> split_at(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (size_t begin = 0;;) {
    const size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin, end - begin + 1);
}

/// The first line of a table that a spreadsheet has written.
bool is_heading(const std::vector<std::string_view>& fields) {
  constexpr std::array<std::string_view, 4> kNames = {"room", "rooms", "name", "names"};
  constexpr std::array<std::string_view, 9> kSources = {"source", "sources", "path",   "folder", "photos",
                                                        "scene",  "input",   "images", "file"};
  const auto is_one_of = [](const auto& words, std::string_view field) {
    return std::find(words.begin(), words.end(), lower_case(trimmed(field))) != words.end();
  };
  return fields.size() > 1 && is_one_of(kNames, fields[0]) && is_one_of(kSources, fields[1]);
}

}  // namespace

std::string line_field(int line) { return "line " + std::to_string(line); }

void require_valid_room(const RoomEntry& room, const std::vector<RoomEntry>& before, const fs::path& list,
                        const char* form) {
  constexpr const char* kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  const std::string field = line_field(room.line);
  if (room.name.empty()) throw_bad_input(list, field, "the room has no name", form);
  if (room.name.size() > kLongestName || room.name.find_first_not_of(kAllowed) != std::string::npos ||
      room.name[0] == '.' || room.name[0] == '-') {
    throw_bad_input(list, field, "this is no name of a room: \"" + room.name.substr(0, kLongestName) + "\"",
                    "use letters, digits, \".\", \"_\" and \"-\", at most 100, with a letter, a digit or \"_\" first");
  }
  const auto twin =
      std::find_if(before.begin(), before.end(), [&](const RoomEntry& other) { return other.name == room.name; });
  if (twin != before.end()) {
    throw_bad_input(list, field,
                    "the room " + room.name + " is listed twice, first in line " + std::to_string(twin->line),
                    "give each room a name of its own");
  }
  if (room.source.empty()) throw_bad_input(list, field, "the room " + room.name + " has no source", form);
  if (room.source.find('\0') != std::string::npos) throw_bad_input(list, field, "the source holds a zero byte", form);
  for (const std::string& word : room.options) {
    if (word.find('\0') != std::string::npos) throw_bad_input(list, field, "an option holds a zero byte", form);
    if (is_own(word)) {
      throw_bad_input(list, field, "a room may not have the option " + word,
                      "leave it out: the batch decides about folder, resuming and output");
    }
  }
}

std::vector<RoomEntry> parse_room_table(std::string_view text, const fs::path& name_for_errors) {
  if (text.rfind("\xef\xbb\xbf", 0) == 0) text.remove_prefix(3);  // spreadsheets write a byte order mark
  std::vector<RoomEntry> rooms;
  int number = 0;
  for (const std::string_view line : split_at(text, '\n')) {
    ++number;
    if (trimmed(line).empty() || trimmed(line)[0] == '#') continue;
    const std::vector<std::string_view> fields = split_at(line, '\t');
    if (rooms.empty() && is_heading(fields)) continue;
    if (fields.size() < 2)
      throw_bad_input(name_for_errors, line_field(number), "there is no tab between room and source", kLineForm);
    RoomEntry room;
    room.line = number;
    room.name = trimmed(fields[0]);
    room.source = trimmed(fields[1]);
    for (size_t i = 2; i < fields.size(); ++i) {
      try {
        for (std::string& word : split_words(trimmed(fields[i]))) room.options.push_back(std::move(word));
      } catch (const Error& error) {
        throw_bad_input(name_for_errors, line_field(number), error.details().message, error.details().remedy);
      }
    }
    require_valid_room(room, rooms, name_for_errors, kLineForm);
    rooms.push_back(std::move(room));
  }
  if (rooms.empty()) throw_bad_input(name_for_errors, "", "the list has no rooms", kLineForm);
  return rooms;
}

std::vector<RoomEntry> read_room_list(const fs::path& path) {
  const std::string content = read_file(path, kLargestRoomList);
  const std::string_view text = text_of_file(content, path);
  return path.extension() == ".toml" ? parse_room_toml(text, path) : parse_room_table(text, path);
}

}  // namespace aligngs
