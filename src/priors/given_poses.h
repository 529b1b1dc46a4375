// Cameras that the user has already: a COLMAP model or a transforms.json, matched to photos by name.
#pragma once

#include <filesystem>
#include <vector>

#include "priors/photo_folder.h"
#include "scene/import/capture.h"

namespace aligngs {

/// Place of the cameras for photos in `photos`: `given` (a folder, or a transforms.json) when it is not empty. Else the
/// folder of the photos, then the one above it. Error{kBadInput} naming the places when there are none.
std::filesystem::path find_given_cameras(const std::filesystem::path& photos, const std::filesystem::path& given);

/// Whether find_given_cameras(photos, "") finds some.
bool has_given_cameras(const std::filesystem::path& photos);

struct GivenPoses {
  /// a frame per photo with a camera; cameras without a photo are only counted, in its notes
  Capture capture;
  std::vector<Photo>
      photos;  ///< the listed ones, with those that the cameras name by another name or extension instead
  std::vector<LeftOut> unplaced;  ///< of these: without a camera, or with one that does not fit
};

/// The photos are found below `photos` by the rules of PhotoLookup. A camera may be for another size of the same
/// aspect; EXIF orientation is left alone where the stored pixels fit it (photo_fit.h). `listed`: the photos that
/// should have a camera.
GivenPoses read_given_poses(const std::filesystem::path& cameras, const std::filesystem::path& photos,
                            const std::vector<Photo>& listed);

}  // namespace aligngs
