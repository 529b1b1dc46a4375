// The folders of a transforms.json and of what it names, where these lie apart.
#pragma once

#include <filesystem>

namespace aligngs {

struct TransformsPlace {
  std::filesystem::path folder;         ///< of the document
  std::filesystem::path photos, masks;  ///< of ScanNet++, beside it; empty: photos are looked for as in any data set
  bool undistorted = false;             ///< the document is transforms_undistorted.json
};

/// ScanNet++ keeps D/nerfstudio/transforms.json beside D/resized_images, and D/nerfstudio/transforms_undistorted.json
/// beside D/resized_undistorted_images. `given` is D or D/nerfstudio. The pair of `photos` counts, else the first one that
/// is whole. A folder with a transforms.json and photos of its own is no such place.
TransformsPlace transforms_place(const std::filesystem::path& given, const std::filesystem::path& photos = {});

}  // namespace aligngs
