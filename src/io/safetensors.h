// safetensors files: an 8-byte header length, a JSON header, raw little-endian tensors.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace aligngs {

struct TensorBytes {
  std::string dtype;  ///< "F32", "F16", "U8", "U64", "I64", ...
  std::vector<int64_t> shape;
  std::vector<uint8_t> bytes;  ///< little-endian, C order
};

struct TensorFile {
  std::map<std::string, TensorBytes> tensors;
  std::map<std::string, std::string> metadata;
};

/// Place of a tensor in a file.
struct TensorPlace {
  std::string dtype;
  std::vector<int64_t> shape;
  uint64_t offset = 0;  ///< bytes from the start of the file
  uint64_t bytes = 0;
};

struct TensorDirectory {
  std::map<std::string, TensorPlace> tensors;
  std::map<std::string, std::string> metadata;
};

class ByteSource;

/// The header alone, checked as below; the tensors are left where they are.
TensorDirectory read_safetensors_directory(const ByteSource& source);
/// One tensor of the directory, converted to float piece by piece: no copy of its bytes is made.
/// Error{kBadInput} for types that are no numbers.
std::vector<float> read_floats(const ByteSource& source, const TensorPlace& place, const std::string& name_for_errors);

/// One tensor of the directory as stored in the file.
TensorBytes read_tensor(const ByteSource& source, const TensorPlace& place);

/// Error{kBadInput} on a malformed header, overlapping or out-of-range offsets, or a truncated file; never
/// allocates more than the file could hold.
TensorFile read_safetensors(const std::filesystem::path& path);
TensorFile decode_safetensors(const std::string& bytes, const std::filesystem::path& name_for_errors);
void write_safetensors(const std::filesystem::path& path, const TensorFile& file);  ///< atomic

/// Bytes of one element of a type; 0 for an unknown type.
unsigned safetensors_item_bytes(const std::string& dtype);

TensorBytes tensor_of(const std::vector<float>& values, std::vector<int64_t> shape = {});  ///< default: one dimension
std::vector<float> floats_of(const TensorBytes& tensor, const std::string& name_for_errors);

}  // namespace aligngs
