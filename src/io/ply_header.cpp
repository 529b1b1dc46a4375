#include "io/ply_header.h"

#include <cmath>
#include <set>
#include <utility>

#include "core/error.h"
#include "io/foreign_content.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

constexpr std::pair<std::string_view, PlyType> kTypeNames[] = {
    {"char", PlyType::kInt8},      {"uchar", PlyType::kUint8},    {"short", PlyType::kInt16},
    {"ushort", PlyType::kUint16},  {"int", PlyType::kInt32},      {"uint", PlyType::kUint32},
    {"float", PlyType::kFloat32},  {"double", PlyType::kFloat64}, {"int8", PlyType::kInt8},
    {"uint8", PlyType::kUint8},    {"int16", PlyType::kInt16},    {"uint16", PlyType::kUint16},
    {"int32", PlyType::kInt32},    {"uint32", PlyType::kUint32},  {"float32", PlyType::kFloat32},
    {"float64", PlyType::kFloat64}};

const char* const kPlyRemedy = "check that this is a PLY file and that it was copied whole";

/// Header lines end in "\n", "\r\n", or in old files "\r"; the first line tells which.
class HeaderLines {
 public:
  HeaderLines(std::string_view bytes, const std::filesystem::path& name) : bytes_(bytes), name_(name) {
    const size_t end = bytes.find_first_of("\r\n");
    if (end != std::string_view::npos && bytes[end] == '\r' && bytes.substr(end + 1, 1) != "\n") terminator_ = '\r';
  }
  std::string_view next() {
    const size_t end = bytes_.find(terminator_, position_);
    if (end == std::string_view::npos) throw_bad_input(name_, "header", "end_header is missing", kPlyRemedy);
    std::string_view line = bytes_.substr(position_, end - position_);
    position_ = end + 1;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }
  size_t position() const { return position_; }

 private:
  std::string_view bytes_;
  const std::filesystem::path& name_;
  char terminator_ = '\n';
  size_t position_ = 0;
};

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::filesystem::path& name) : lines_(bytes, name), name_(name) {}

  PlyHeader read() {
    if (trimmed(lines_.next()) != "ply") throw_bad_input(name_, "magic", "not a PLY file", kPlyRemedy);
    bool has_format = false;
    while (true) {
      const std::string_view line = lines_.next();
      std::string_view rest = line;
      const std::string_view keyword = take_word(rest);
      if (keyword == "end_header") break;
      if (keyword.empty() || keyword == "obj_info") continue;
      if (keyword == "comment") {
        header_.file.comments.emplace_back(rest.empty() ? rest : rest.substr(1));
      } else if (keyword == "format") {
        read_format(line, rest);
        has_format = true;
      } else if (keyword == "element") {
        read_element(line, rest);
      } else if (keyword == "property") {
        read_property(line, rest);
      } else {
        fail(line, "unknown keyword");
      }
    }
    if (!has_format) throw_bad_input(name_, "format", "missing", kPlyRemedy);
    for (const PlyElement& element : header_.file.elements) {
      if (element.properties.empty() && element.count > 0) {
        throw_bad_input(name_, "element " + element.name, "has no properties", kPlyRemedy);
      }
    }
    header_.body = lines_.position();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(std::string_view line, const std::string& message) const {
    throw_bad_input(name_, "header line '" + std::string(line.substr(0, 200)) + "'", message, kPlyRemedy);
  }

  PlyType type(std::string_view line, std::string_view word) const {
    for (const auto& [type_name, value] : kTypeNames) {
      if (word == type_name) return value;
    }
    fail(line, "unknown type '" + std::string(word.substr(0, 40)) + "'");
  }

  void read_format(std::string_view line, std::string_view rest) {
    const std::string_view format = take_word(rest);
    if (format == "ascii") {
      header_.format = PlyFormat::kAscii;
    } else if (format == "binary_little_endian") {
      header_.format = PlyFormat::kLittleEndian;
    } else if (format == "binary_big_endian") {
      header_.format = PlyFormat::kBigEndian;
    } else {
      fail(line, "unknown format");
    }
    if (take_word(rest) != "1.0") fail(line, "unknown version");
  }

  void read_element(std::string_view line, std::string_view rest) {
    PlyElement element;
    element.name = take_word(rest);
    if (!parse_number(take_word(rest), element.count)) fail(line, "the count is not a number");
    if (element.name.empty() || !take_word(rest).empty()) fail(line, "a name and a count expected");
    if (!element_names_.insert(element.name).second) fail(line, "the element is declared twice");
    header_.file.elements.push_back(std::move(element));
    header_.list_counts.emplace_back();
    property_names_.clear();
  }

  void read_property(std::string_view line, std::string_view rest) {
    if (header_.file.elements.empty()) fail(line, "no element before it");
    PlyProperty property;
    std::string_view word = take_word(rest);
    PlyType count_type = PlyType::kUint8;
    if (word == "list") {
      property.is_list = true;
      count_type = type(line, take_word(rest));
      if (count_type == PlyType::kFloat32 || count_type == PlyType::kFloat64) fail(line, "a list length is an integer");
      word = take_word(rest);
    }
    property.type = type(line, word);
    property.name = take_word(rest);
    if (property.name.empty() || !take_word(rest).empty()) fail(line, "a type and a name expected");
    if (!property_names_.insert(property.name).second) fail(line, "the property is declared twice");
    header_.file.elements.back().properties.push_back(std::move(property));
    header_.list_counts.back().push_back(count_type);
  }

  HeaderLines lines_;
  const std::filesystem::path& name_;
  PlyHeader header_;
  std::set<std::string> element_names_, property_names_;
};

}  // namespace

PlyHeader parse_ply_header(std::string_view bytes, const std::filesystem::path& name) {
  if (bytes.substr(0, 3) != "ply") {
    refuse_foreign_content(bytes, name);
    throw_bad_input(name, "magic", "not a PLY file",
                    "PLY alone is read here: convert other formats, or copy the file again if it is one");
  }
  return HeaderReader(bytes, name).read();
}

size_t ply_type_bytes(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kFloat64:
      return 8;
    default:
      return 4;
  }
}

bool ply_value_fits(double value, PlyType type) {
  const auto in = [&](double low, double high) { return value >= low && value <= high && value == std::floor(value); };
  switch (type) {
    case PlyType::kInt8:
      return in(-128, 127);
    case PlyType::kUint8:
      return in(0, 255);
    case PlyType::kInt16:
      return in(-32768, 32767);
    case PlyType::kUint16:
      return in(0, 65535);
    case PlyType::kInt32:
      return in(-2147483648.0, 2147483647.0);
    case PlyType::kUint32:
      return in(0, 4294967295.0);
    default:
      return true;
  }
}

const char* ply_type_name(PlyType type) {
  for (const auto& [type_name, value] : kTypeNames) {
    if (value == type) return type_name.data();
  }
  return "";
}

}  // namespace aligngs
