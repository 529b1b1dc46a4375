// What a COLMAP model must fulfil, however it was stored. src/io internal: use io/colmap.h.
#pragma once

#include <filesystem>

#include "io/colmap.h"

namespace aligngs {

/// Error{kBadInput} for impossible sizes, values that are not finite, zero quaternions, nameless
/// images, ids that occur twice and images without a camera. The paths are those to name in errors.
void require_valid_colmap(const ColmapModel& model, const std::filesystem::path& cameras,
                          const std::filesystem::path& images, const std::filesystem::path& points);

}  // namespace aligngs
