// Large tensors of a finished run's checkpoint, compressed: most class scores are one value, and most harmonics zero.
#pragma once

#include <filesystem>

#include "io/safetensors.h"

namespace aligngs {

/// Replaces every tensor of at least 64 KiB that becomes smaller by "gzip.NAME" (U8) and the metadata "gzip.NAME", its
/// type and shape: "F32 1000 150". Floats most of which are one value become "sparse.NAME" (sparse_floats.h, then gzip);
/// the bits of that value precede type and shape: "3239271822 F32 1000 150". Nothing is lost.
void pack_tensors(TensorFile& file);

/// Undoes pack_tensors(). Error{kBadInput} for a damaged stream, or a type or shape that does not fit it.
void unpack_tensors(TensorFile& file, const std::filesystem::path& path_for_errors);

}  // namespace aligngs
