// The planes of a checkpoint (plane_targets.h).
#pragma once

#include <filesystem>

#include "io/safetensors.h"
#include "train/plane_targets.h"

namespace aligngs {

/// Adds tensors "planes.*"; none for empty targets.
void put_planes(const PlaneTargets& targets, TensorFile& file);
/// Empty targets where the file has none. Error{kBadInput} when tensors do not fit each other or number planes that are
/// not there.
PlaneTargets take_planes(const TensorFile& file, const std::filesystem::path& path);

}  // namespace aligngs
