// pred_confidence/ of a scene folder.
#pragma once

#include <filesystem>
#include <string>

#include "core/image.h"

namespace aligngs {

/// FOLDER/pred_confidence/NAME.npy: float16, H x W; 0 = nothing is known; of the other values (VGGT: >= 1) only the
/// order and spread count.
void write_confidence(const std::filesystem::path& folder, const std::string& name, const ImageF& confidence);
/// The same to a file by its own name.
void write_confidence_map(const std::filesystem::path& file, const ImageF& confidence);

}  // namespace aligngs
