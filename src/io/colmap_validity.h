// Conditions on a COLMAP model, however it was stored. src/io internal: use io/colmap.h.
#pragma once

#include <filesystem>

#include "io/colmap.h"

namespace aligngs {

/// Error{kBadInput} for impossible sizes, values that are not finite, zero quaternions, nameless
/// images, ids that occur twice and images without a camera. The paths are those to name in errors.
void require_valid_colmap(const ColmapModel& model, const std::filesystem::path& cameras,
                          const std::filesystem::path& images, const std::filesystem::path& points);

/// The reader's side: images without a finite pose, a name or a valid camera, or listed twice, go to model.left_out.
/// Points that are not finite are counted. Error{kBadInput} only for a camera id that occurs twice, since either could
/// be meant.
void leave_out_invalid(ColmapModel& model, const std::filesystem::path& cameras, const std::filesystem::path& images);

}  // namespace aligngs
