#include <algorithm>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/ply.h"
#include "io/ply_header.h"

namespace aligngs {
namespace {

void append_value(std::string& out, double value, PlyType type) {
  switch (type) {
    case PlyType::kInt8:
      return append_little(out, int8_t(value));
    case PlyType::kUint8:
      return append_little(out, uint8_t(value));
    case PlyType::kInt16:
      return append_little(out, int16_t(value));
    case PlyType::kUint16:
      return append_little(out, uint16_t(value));
    case PlyType::kInt32:
      return append_little(out, int32_t(value));
    case PlyType::kUint32:
      return append_little(out, uint32_t(value));
    case PlyType::kFloat32:
      return append_little(out, float(value));
    case PlyType::kFloat64:
      return append_little(out, value);
  }
}

/// The type of list lengths on writing: the usual uchar, or int where a list is longer.
PlyType written_count_type(const PlyProperty& property) {
  uint64_t longest = 0;
  for (size_t i = 1; i < property.offsets.size(); ++i) {
    longest = std::max(longest, property.offsets[i] - property.offsets[i - 1]);
  }
  return longest <= 255 ? PlyType::kUint8 : PlyType::kInt32;
}

void require_writable(const PlyElement& element, const std::filesystem::path& path) {
  for (const PlyProperty& property : element.properties) {
    const auto refuse = [&](const std::string& message) {
      throw Error({ErrorKind::kFailed, message, path, element.name + "." + property.name, ""});
    };
    const bool complete = property.is_list
                              ? property.offsets.size() == element.count + 1 && property.offsets.front() == 0 &&
                                    std::is_sorted(property.offsets.begin(), property.offsets.end()) &&
                                    property.offsets.back() == property.values.size()
                              : property.values.size() == element.count;
    if (!complete) refuse("the column does not have one entry per row");
    for (const double value : property.values) {
      if (!ply_value_fits(value, property.type)) {
        refuse(std::to_string(value) + " does not fit the type " + ply_type_name(property.type));
      }
    }
  }
}

}  // namespace

void write_ply(const std::filesystem::path& path, const PlyFile& file) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : file.comments) header += "comment " + comment + "\n";
  for (const PlyElement& element : file.elements) {
    require_writable(element, path);
    header += "element " + element.name + " " + std::to_string(element.count) + "\n";
    for (const PlyProperty& property : element.properties) {
      header += "property ";
      if (property.is_list) header += std::string("list ") + ply_type_name(written_count_type(property)) + " ";
      header += std::string(ply_type_name(property.type)) + " " + property.name + "\n";
    }
  }
  AtomicFile out(path);
  out.write(header + "end_header\n");
  std::string block;
  constexpr size_t kBlockBytes = size_t(1) << 16;
  for (const PlyElement& element : file.elements) {
    std::vector<PlyType> count_types;
    for (const PlyProperty& property : element.properties) count_types.push_back(written_count_type(property));
    for (uint64_t row = 0; row < element.count; ++row) {
      for (size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        const uint64_t begin = property.is_list ? property.offsets[row] : row;
        const uint64_t end = property.is_list ? property.offsets[row + 1] : row + 1;
        if (property.is_list) append_value(block, double(end - begin), count_types[p]);
        for (uint64_t i = begin; i < end; ++i) append_value(block, property.values[i], property.type);
      }
      if (block.size() >= kBlockBytes) {
        out.write(block);
        block.clear();
      }
    }
  }
  out.write(block);
  out.commit();
}

}  // namespace aligngs
