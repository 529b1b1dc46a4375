#include "scene/photo_places.h"

#include "core/shell_word.h"
#include "io/colmap.h"

namespace aligngs {

namespace fs = std::filesystem;

fs::path images_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder / "images", error)) return folder / "images";
  constexpr int kLargestDivisor = 64;  // photos of 4000 pixels are 62 wide then
  for (int divisor = 2; divisor <= kLargestDivisor; ++divisor) {
    const fs::path shrunk = folder / ("images_" + std::to_string(divisor));
    if (fs::is_directory(shrunk, error)) return shrunk;
  }
  const fs::path scannetpp = folder / "resized_images";
  return fs::is_directory(scannetpp, error) ? scannetpp : fs::path();
}

bool fits_other_cameras(const fs::path& photos) {
  const std::string name = photos.filename().string();
  return name == "resized_undistorted_images" || name.ends_with("_masks");
}

fs::path data_set_around(const fs::path& folder) {
  std::error_code error;
  fs::path place = fs::absolute(folder, error).lexically_normal();
  if (place.filename().empty()) place = place.parent_path();
  constexpr int kLevels = 2;  // sparse/0
  for (int level = 0; level < kLevels && place.has_relative_path(); ++level) {
    place = place.parent_path();
    if (!images_folder(place).empty()) return place;
  }
  return {};
}

std::string missing_photos_remedy(const fs::path& folder) {
  const fs::path around = images_folder(folder).empty() ? data_set_around(folder) : fs::path();
  if (around.empty()) return "put the images that COLMAP used into images/";
  if (!may_hold_colmap_model(around))  // one of several models beside the photos
    return "`aligngs import " + quote_word(folder.string()) + " -o SCENE` finds them in " + around.string();
  return "give the folder that has the photos as well: " + around.string();
}

}  // namespace aligngs
