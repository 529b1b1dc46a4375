// Names under which the maps of an image may be found.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

namespace aligngs {

/// "left/0001.color.png" has the view name "left/0001.color" (up to the last dot) and the short name "left/0001" (up to
/// the first dot of the file).
std::string short_name(const std::string& image_name);

/// The short name counts only while no other image has it: "a.1.png" and "a.2.png" must not share the map "a.npy".
class MapNames {
 public:
  explicit MapNames(const std::vector<std::string>& image_names);

  /// The first existing <folder>/<stem><extension>; empty when there is none. Error{kBadInput} where the first stem
  /// that has a file has several: nobody could tell which one is meant.
  std::filesystem::path find(const std::filesystem::path& folder, const std::string& image_name,
                             std::initializer_list<const char*> extensions) const;

 private:
  std::map<std::string, int> uses_;
};

}  // namespace aligngs
