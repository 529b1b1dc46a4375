// NumPy .npy arrays (format 1.0 to 3.0), little- and big-endian, C and Fortran order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace aligngs {

/// An array of any numeric dtype, converted to float on read.
struct FloatArray {
  std::vector<int64_t> shape;
  std::vector<float> data;  ///< C order
};

struct ArrayHeader {
  std::vector<int64_t> shape;
  std::string dtype;  ///< e.g. "<f2", "float16"
};

/// Checks magic, header, dtype, shape and that the file has exactly the bytes the shape needs.
ArrayHeader read_npy_header(const std::filesystem::path& path);
/// The same from the beginning of an array of `size` bytes.
ArrayHeader decode_npy_header(std::string_view beginning, uint64_t size, const std::filesystem::path& name_for_errors);
FloatArray read_npy(const std::filesystem::path& path);
FloatArray decode_npy(const std::string& bytes, const std::filesystem::path& name_for_errors);

void write_npy_float32(const std::filesystem::path& path, const std::vector<int64_t>& shape, const float* data);
/// `data` holds IEEE half bits.
void write_npy_float16(const std::filesystem::path& path, const std::vector<int64_t>& shape, const uint16_t* data);
/// The bytes of such a file.
std::string encode_npy_float16(const std::filesystem::path& name_for_errors, const std::vector<int64_t>& shape,
                               const uint16_t* data);

}  // namespace aligngs
