// The list of a batch: rooms, their sources and their options, as TSV or TOML.
//
//   # room <TAB> source <TAB> options
//   kitchen	photos/kitchen	--method colmap --semantics none
//   trial	demo	--room kitchen --views 12
//
//   options = ["--preset", "preview"]     # of all rooms
//   [[room]]
//   name = "kitchen"
//   source = "photos/kitchen"
//   options = "--method colmap"           # a text, or a list of words
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace aligngs {

/// The source that makes a synthetic room: `aligngs demo` instead of `aligngs run`. A folder of that name is "./demo".
inline constexpr const char* kSyntheticSource = "demo";

struct RoomEntry {
  std::string name;                  ///< letters, digits, ".", "_" and "-", at most 100; names the run folder
  std::string source;                ///< as in the list: a folder, relative to the list's, or kSyntheticSource
  std::vector<std::string> options;  ///< of `aligngs run` or `aligngs demo`
  int line = 0;                      ///< in the list, from 1

  bool synthetic() const { return source == kSyntheticSource; }
};

/// Both: Error{kBadInput} for a list without rooms. Error{kBadInput} with the line for a wrong name, a name given
/// twice, a missing source, and an option that the batch sets itself.
std::vector<RoomEntry> parse_room_table(std::string_view text, const std::filesystem::path& name_for_errors);
std::vector<RoomEntry> parse_room_toml(std::string_view text, const std::filesystem::path& name_for_errors);

/// TOML where the file's name ends in .toml, else TSV.
std::vector<RoomEntry> read_room_list(const std::filesystem::path& path);

/// "line N"
std::string line_field(int line);
/// Error{kBadInput} for an entry that no list may have. `before` are those above it, `form` says how the list is written.
void require_valid_room(const RoomEntry& room, const std::vector<RoomEntry>& before, const std::filesystem::path& list,
                        const char* form);

}  // namespace aligngs
