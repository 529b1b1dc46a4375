// One tensor from a torch.save file (either layout), read by a whitelist: nothing is executed.
#pragma once

#include "io/npy.h"

namespace aligngs {

/// The one tensor of the file (a bare tensor, or a dict or list holding exactly one). Half,
/// bfloat16, float, double and integer storages, strided views. Error{kBadInput} for anything else,
/// naming what was met.
FloatArray read_torch_tensor(const std::filesystem::path& path);
ArrayHeader read_torch_tensor_header(const std::filesystem::path& path);
FloatArray decode_torch_tensor(const std::string& bytes, const std::filesystem::path& name_for_errors);

/// Writes a float32 tensor as torch.save would (stored zip); for tests and interchange.
void write_torch_tensor(const std::filesystem::path& path, const std::vector<int64_t>& shape, const float* data);

}  // namespace aligngs
