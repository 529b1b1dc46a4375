#include "scene/map_names.h"

#include "core/error.h"
#include "scene/photo_lookup.h"
#include "scene/view_names.h"

namespace aligngs {

namespace fs = std::filesystem;

std::string short_name(const std::string& image_name) {
  const fs::path path(image_name);
  const std::string file = path.filename().string();
  return (path.parent_path() / file.substr(0, file.find('.', 1))).generic_string();
}

MapNames::MapNames(const std::vector<std::string>& image_names) {
  for (const std::string& name : image_names) ++uses_[short_name(name)];
}

fs::path MapNames::find(const fs::path& folder, const std::string& image_name,
                        std::initializer_list<const char*> extensions) const {
  std::vector<std::string> stems = {view_name_of(image_name)};
  const fs::path as_written(slashed_name(image_name));
  stems.push_back((as_written.parent_path() / as_written.stem()).generic_string());  // a name that is no UTF-8
  const std::string brief = short_name(image_name);
  if (uses_.at(brief) == 1) stems.push_back(brief);
  for (const std::string& stem : stems) {
    fs::path found;
    for (const char* extension : extensions) {
      fs::path path = folder / (stem + extension);
      if (!fs::is_regular_file(path)) continue;
      if (!found.empty()) {
        throw_bad_input(path, "map", "the view has " + found.filename().string() + " as well", "remove one of the two");
      }
      found = std::move(path);
    }
    if (!found.empty()) return found;
  }
  return {};
}

}  // namespace aligngs
