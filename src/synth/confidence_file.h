// pred_confidence/ of a scene folder.
#pragma once

#include <filesystem>
#include <string>

#include "core/image.h"

namespace aligngs {

/// FOLDER/pred_confidence/NAME.npy: float16, H x W, >= 1 as VGGT's, 0 = no value.
void write_confidence(const std::filesystem::path& folder, const std::string& name, const ImageF& confidence);

}  // namespace aligngs
