// Format: Greg Turk, "The PLY Polygon File Format", 1994, with the type names of later writers.
#include "io/ply.h"

#include <algorithm>
#include <string_view>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/ply_header.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

double load_value(const char* bytes, PlyType type, bool big) {
  switch (type) {
    case PlyType::kInt8:
      return load_number<int8_t>(bytes, big);
    case PlyType::kUint8:
      return load_number<uint8_t>(bytes, big);
    case PlyType::kInt16:
      return load_number<int16_t>(bytes, big);
    case PlyType::kUint16:
      return load_number<uint16_t>(bytes, big);
    case PlyType::kInt32:
      return load_number<int32_t>(bytes, big);
    case PlyType::kUint32:
      return load_number<uint32_t>(bytes, big);
    case PlyType::kFloat32:
      return load_number<float>(bytes, big);
    case PlyType::kFloat64:
      return load_number<double>(bytes, big);
  }
  return 0;
}

/// The values of one type that lie `stride` bytes apart.
template <class T>
void load_column(const char* bytes, size_t stride, bool big, size_t rows, double* out) {
  for (size_t i = 0; i < rows; ++i) out[i] = static_cast<double>(load_number<T>(bytes + i * stride, big));
}

void load_column(PlyType type, const char* bytes, size_t stride, bool big, size_t rows, double* out) {
  switch (type) {
    case PlyType::kInt8:
      return load_column<int8_t>(bytes, stride, big, rows, out);
    case PlyType::kUint8:
      return load_column<uint8_t>(bytes, stride, big, rows, out);
    case PlyType::kInt16:
      return load_column<int16_t>(bytes, stride, big, rows, out);
    case PlyType::kUint16:
      return load_column<uint16_t>(bytes, stride, big, rows, out);
    case PlyType::kInt32:
      return load_column<int32_t>(bytes, stride, big, rows, out);
    case PlyType::kUint32:
      return load_column<uint32_t>(bytes, stride, big, rows, out);
    case PlyType::kFloat32:
      return load_column<float>(bytes, stride, big, rows, out);
    case PlyType::kFloat64:
      return load_column<double>(bytes, stride, big, rows, out);
  }
}

std::string field_name(const PlyElement& element, const PlyProperty& property, uint64_t row) {
  return element.name + "." + property.name + " of row " + std::to_string(row);
}

/// Room for the rows, after `min_row_bytes` has shown that the file can hold them.
void allocate_rows(PlyElement& element, uint64_t min_row_bytes, const ByteReader& reader) {
  reader.count_of(element.count, min_row_bytes, "element " + element.name);
  for (PlyProperty& property : element.properties) {
    if (property.is_list) {
      property.offsets.reserve(element.count + 1);
      property.offsets.push_back(0);
    } else {
      property.values.resize(element.count);
    }
  }
}

void read_binary_element(PlyElement& element, const std::vector<PlyType>& count_types, bool big, ByteReader& reader) {
  uint64_t row_bytes = 0;
  bool has_list = false;
  for (size_t p = 0; p < element.properties.size(); ++p) {
    const PlyProperty& property = element.properties[p];
    has_list |= property.is_list;
    row_bytes += ply_type_bytes(property.is_list ? count_types[p] : property.type);
  }
  if (element.count == 0 || row_bytes == 0) return allocate_rows(element, 1, reader);
  allocate_rows(element, row_bytes, reader);

  if (!has_list) {
    const char* bytes = reader.take(element.count * row_bytes, "element " + element.name).data();
    // A block of rows stays in the cache while its columns are taken out one after the other.
    constexpr uint64_t kBlockRows = 64;
    for (uint64_t first = 0; first < element.count; first += kBlockRows) {
      const size_t rows = size_t(std::min(kBlockRows, element.count - first));
      const char* column = bytes + first * row_bytes;
      for (PlyProperty& property : element.properties) {
        load_column(property.type, column, row_bytes, big, rows, property.values.data() + first);
        column += ply_type_bytes(property.type);
      }
    }
    return;
  }
  for (uint64_t row = 0; row < element.count; ++row) {
    for (size_t p = 0; p < element.properties.size(); ++p) {
      PlyProperty& property = element.properties[p];
      const size_t item_bytes = ply_type_bytes(property.type);
      if (!property.is_list) {
        if (reader.remaining() < item_bytes) reader.take(item_bytes, field_name(element, property, row));
        property.values[row] = load_value(reader.take(item_bytes, "").data(), property.type, big);
        continue;
      }
      const size_t count_bytes = ply_type_bytes(count_types[p]);
      if (reader.remaining() < count_bytes) reader.take(count_bytes, field_name(element, property, row));
      const double length = load_value(reader.take(count_bytes, "").data(), count_types[p], big);
      const size_t most = reader.remaining() / item_bytes;
      if (length < 0 || length > static_cast<double>(most)) {
        reader.fail(field_name(element, property, row), "the file cannot hold a list of that length");
      }
      const size_t items = size_t(length), begin = property.values.size();
      const char* bytes = reader.take(items * item_bytes, "").data();
      property.values.resize(begin + items);
      load_column(property.type, bytes, item_bytes, big, items, property.values.data() + begin);
      property.offsets.push_back(property.values.size());
    }
  }
}

double read_ascii_value(const PlyElement& element, const PlyProperty& property, PlyType type, uint64_t row,
                        std::string_view& text, const ByteReader& reader) {
  const std::string_view word = take_word(text);
  if (word.empty()) reader.fail(field_name(element, property, row), "the file ends too early");
  double value = 0;
  if (!parse_number(word, value) || !ply_value_fits(value, type)) {
    reader.fail(field_name(element, property, row),
                "'" + std::string(word.substr(0, 40)) + "' is no " + ply_type_name(type));
  }
  return value;
}

/// `text` is the rest of the file; the reader only serves for errors and bounds.
void read_ascii_element(PlyElement& element, const std::vector<PlyType>& count_types, std::string_view& text,
                        const std::filesystem::path& name) {
  const ByteReader reader(text, name);
  // A value takes a digit and a separator, but for the last of the file; one byte each is a safe
  // bound.
  allocate_rows(element, std::max<uint64_t>(element.properties.size(), 1), reader);
  for (uint64_t row = 0; row < element.count; ++row) {
    for (size_t p = 0; p < element.properties.size(); ++p) {
      PlyProperty& property = element.properties[p];
      if (!property.is_list) {
        property.values[row] = read_ascii_value(element, property, property.type, row, text, reader);
        continue;
      }
      const double length = read_ascii_value(element, property, count_types[p], row, text, reader);
      if (length < 0 || length > double(text.size())) {
        reader.fail(field_name(element, property, row), "the file cannot hold a list of that length");
      }
      for (double i = 0; i < length; ++i) {
        property.values.push_back(read_ascii_value(element, property, property.type, row, text, reader));
      }
      property.offsets.push_back(property.values.size());
    }
  }
}

}  // namespace

const PlyProperty* PlyElement::find(const std::string& property) const {
  for (const PlyProperty& p : properties) {
    if (p.name == property) return &p;
  }
  return nullptr;
}

const PlyElement* PlyFile::find(const std::string& element) const {
  for (const PlyElement& e : elements) {
    if (e.name == element) return &e;
  }
  return nullptr;
}

PlyFile decode_ply(const std::string& bytes, const std::filesystem::path& name_for_errors) {
  PlyHeader header = parse_ply_header(bytes, name_for_errors);
  std::string_view body = std::string_view(bytes).substr(header.body);
  ByteReader reader(body, name_for_errors);
  for (size_t e = 0; e < header.file.elements.size(); ++e) {
    PlyElement& element = header.file.elements[e];
    if (header.format == PlyFormat::kAscii) {
      read_ascii_element(element, header.list_counts[e], body, name_for_errors);
    } else {
      read_binary_element(element, header.list_counts[e], header.format == PlyFormat::kBigEndian, reader);
    }
  }
  return std::move(header.file);
}

PlyFile read_ply(const std::filesystem::path& path) { return decode_ply(read_file(path), path); }

}  // namespace aligngs
