#include "scene/import/transforms_place.h"

#include <string>

#include "scene/photo_places.h"

namespace aligngs {

namespace fs = std::filesystem;

TransformsPlace transforms_place(const fs::path& given, const fs::path& photos) {
  std::error_code error;
  fs::path place = fs::absolute(given, error).lexically_normal();
  if (place.filename().empty()) place = place.parent_path();
  const bool inside = place.filename() == "nerfstudio";
  const bool own = fs::is_regular_file(given / "transforms.json", error);
  if (own && (!inside || !images_folder(given).empty())) return {given, {}, {}};
  const fs::path around = inside ? (given / "..").lexically_normal() : given;
  const fs::path documents = inside ? given : given / "nerfstudio";
  TransformsPlace first{given, {}, {}};
  for (const bool undistorted : {false, true}) {
    const std::string kind = undistorted ? "resized_undistorted" : "resized";
    const TransformsPlace pair{documents, around / (kind + "_images"),
                               around / (kind + (undistorted ? "_masks" : "_anon_masks")), undistorted};
    const fs::path file = documents / (undistorted ? "transforms_undistorted.json" : "transforms.json");
    if (!fs::is_regular_file(file, error) || !fs::is_directory(pair.photos, error)) continue;
    if (!photos.empty() && fs::equivalent(photos, pair.photos, error)) return pair;
    if (first.photos.empty()) first = pair;
  }
  return first;
}

}  // namespace aligngs
