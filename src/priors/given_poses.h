// Cameras that the user has already: a COLMAP model or a transforms.json, matched to photos by name.
#pragma once

#include <filesystem>
#include <vector>

#include "priors/colmap_poses.h"
#include "scene/import/capture.h"

namespace aligngs {

/// Where cameras for photos in `photos` are: `given` (a folder, or a transforms.json) when it is not
/// empty, else the folder of the photos, then the one above it. Error{kBadInput} naming the places
/// when there are none.
std::filesystem::path find_given_cameras(const std::filesystem::path& photos,
                                         const std::filesystem::path& given);

struct GivenPoses {
  Capture capture;  ///< a frame per photo with a camera, of the size and file in `prepared`
  std::vector<UnplacedPhoto> unplaced;
};

/// `listed` are the photos as they are, `prepared` their copies (prepare_photos, same order). A
/// camera may be for another size of the same aspect. Error{kBadInput} for one of another aspect,
/// and when two entries name one photo.
GivenPoses read_given_poses(const std::filesystem::path& cameras, const std::vector<Photo>& listed,
                            const std::vector<Photo>& prepared);

}  // namespace aligngs
