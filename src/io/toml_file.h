// TOML settings files as a flat table of dotted keys ("checkpoint.every").
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace aligngs {

/// An array of integers is read as doubles; an empty array as an empty list of doubles.
using TomlValue = std::variant<bool, int64_t, double, std::string, std::vector<double>, std::vector<std::string>>;

struct TomlEntry {
  TomlValue value;
  int line = 0;  ///< in the file, from 1: for messages about values that the reader does not like
};

using TomlTable = std::map<std::string, TomlEntry>;

/// Error{kBadInput} with the line for syntax errors. The same for values that a flat table cannot
/// hold: dates, arrays of tables or of mixed types, keys that contain a dot.
TomlTable read_toml(const std::filesystem::path& path);
TomlTable parse_toml(std::string_view text, const std::filesystem::path& name_for_errors);
/// One value as written behind "key =", e.g. `0.5`, `true`, `"text"`, `[1, 2]`.
TomlValue parse_toml_value(std::string_view text, const std::string& field_for_errors);

/// Keys sorted, grouped in [tables]; doubles are written with as many digits as they need to come
/// back exactly.
std::string format_toml(const std::map<std::string, TomlValue>& values);
void write_toml(const std::filesystem::path& path, const std::map<std::string, TomlValue>& values);  ///< atomic

}  // namespace aligngs
