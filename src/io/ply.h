// PLY files: ascii and binary of both endiannesses, any scalar types, any property order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace aligngs {

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

/// One element ("vertex", "face") as columns. Scalar columns are converted to double; a list column keeps all
/// items in one array with an offset per row.
struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  bool is_list = false;
  std::vector<double> values;     ///< scalar: one per row; list: the items of all rows
  std::vector<uint64_t> offsets;  ///< list: rows + 1 entries
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
  const PlyProperty* find(const std::string& property) const;  ///< nullptr when absent
};

struct PlyFile {
  std::vector<std::string> comments;
  std::vector<PlyElement> elements;
  const PlyElement* find(const std::string& element) const;
};

/// Error{kBadInput} for bad headers, counts the file cannot hold, truncated bodies.
PlyFile read_ply(const std::filesystem::path& path);
PlyFile decode_ply(const std::string& bytes, const std::filesystem::path& name_for_errors);
/// Binary little-endian, atomic; values are cast to each property's type.
void write_ply(const std::filesystem::path& path, const PlyFile& file);

}  // namespace aligngs
