// NumPy .npz archives of one array: what numpy.savez_compressed writes, and smaller than .npy where most values are 0.
#pragma once

#include "io/npy.h"

namespace aligngs {

/// The only array of an archive. Error{kBadInput} when it holds none or several, or when it is damaged.
FloatArray read_npz(const std::filesystem::path& path);
FloatArray decode_npz(const std::string& bytes, const std::filesystem::path& name_for_errors);
/// Decompresses the beginning of the array alone.
ArrayHeader read_npz_header(const std::filesystem::path& path);

/// The array "arr_0", compressed. No times: equal arrays give equal bytes. `data` holds IEEE half bits.
void write_npz_float16(const std::filesystem::path& path, const std::vector<int64_t>& shape, const uint16_t* data);

}  // namespace aligngs
