// The text header of a PLY file. src/io internal: use io/ply.h.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "io/ply.h"

namespace aligngs {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  PlyFile file;                                   ///< elements and properties without values
  std::vector<std::vector<PlyType>> list_counts;  ///< per element and property: the type of a list's length
  size_t body = 0;                                ///< offset of the first byte after the header
};

PlyHeader parse_ply_header(std::string_view bytes, const std::filesystem::path& name);
size_t ply_type_bytes(PlyType type);
const char* ply_type_name(PlyType type);  ///< the 1994 names: char, uchar, short, ...

/// Whether a value can be stored in the type without loss of range; integers must be whole.
bool ply_value_fits(double value, PlyType type);

}  // namespace aligngs
