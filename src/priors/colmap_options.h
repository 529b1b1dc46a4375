// Options of the COLMAP program under the names that the installed version knows: 3.13 renamed some.
#pragma once

#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace aligngs {

class ColmapOptions {
 public:
  /// `help`: what `colmap COMMAND -h` prints.
  explicit ColmapOptions(std::string_view help);

  bool knows(const std::string& name) const { return names_.count(name) > 0; }
  /// Adds "--NAME VALUE" under the first of `names` that the program knows; the last name, the oldest, when its help
  /// listed no option at all. An option under no known name is left to the program's default.
  void add(std::vector<std::string>& arguments, std::initializer_list<const char*> names,
           const std::string& value) const;

 private:
  std::set<std::string> names_;
};

}  // namespace aligngs
