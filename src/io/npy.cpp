// Format: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#include "io/npy.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <string_view>

#include "core/error.h"
#include "core/half.h"
#include "io/array_shape.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/damaged_file.h"
#include "io/file_system_error.h"
#include "io/foreign_content.h"
#include "io/text_tokens.h"
#include "io/waiting_file.h"

namespace aligngs {
namespace {

constexpr size_t kMaxHeaderBytes = size_t(1) << 20;  // NumPy writes 118 bytes; version 2 allows 4 GiB
const char* const kNpyRemedy = "write it again with numpy.save";

/// Content of the header, with the dtype taken apart.
struct Layout {
  ArrayHeader header;
  bool fortran_order = false;
  bool big_endian = false;
  char kind = 'f';  ///< f, i, u or b (bool)
  unsigned item_bytes = 4;
  size_t data_offset = 0;
  uint64_t count = 0;  ///< elements
};

/// The Python dictionary literal of the header: string keys; strings, booleans and tuples of
/// integers as values.
class HeaderParser {
 public:
  HeaderParser(std::string_view text, const std::filesystem::path& name) : rest_(text), name_(name) {}

  void parse(Layout& layout) {
    bool has_descr = false, has_order = false, has_shape = false;
    expect('{');
    while (!accept('}')) {
      const std::string key = quoted();
      expect(':');
      if (key == "descr") {
        if (peek() != '\'' && peek() != '"') {
          throw_bad_input(name_, "descr", "structured arrays are not supported", "save one plain numeric array");
        }
        layout.header.dtype = quoted();
        has_descr = true;
      } else if (key == "fortran_order") {
        layout.fortran_order = boolean();
        has_order = true;
      } else if (key == "shape") {
        layout.header.shape = tuple();
        has_shape = true;
      } else {
        fail("unknown key '" + key + "'");
      }
      if (!accept(',') && peek() != '}') fail("',' or '}' expected");
    }
    if (!trimmed(rest_).empty()) fail("text after the dictionary");
    if (!has_descr || !has_order || !has_shape) fail("descr, fortran_order or shape is missing");
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw_bad_input(name_, "header", message, kNpyRemedy); }

  char peek() {
    while (!rest_.empty() && is_space(rest_[0])) rest_.remove_prefix(1);
    return rest_.empty() ? '\0' : rest_[0];
  }
  bool accept(char c) {
    if (peek() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail(std::string("'") + c + "' expected");
  }
  std::string quoted() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') fail("a quoted string expected");
    const size_t end = rest_.find(quote, 1);
    if (end == std::string_view::npos) fail("a string does not end");
    std::string text(rest_.substr(1, end - 1));
    rest_.remove_prefix(end + 1);
    return text;
  }
  bool boolean() {
    peek();
    for (const auto& [word, value] : {std::pair<std::string_view, bool>{"True", true}, {"False", false}}) {
      if (rest_.substr(0, word.size()) == word) {
        rest_.remove_prefix(word.size());
        return value;
      }
    }
    fail("True or False expected");
  }
  std::vector<int64_t> tuple() {
    std::vector<int64_t> values;
    expect('(');
    while (!accept(')')) {
      peek();
      size_t end = 0;
      while (end < rest_.size() && (std::isdigit(static_cast<unsigned char>(rest_[end])) || rest_[end] == '-')) ++end;
      int64_t value = 0;
      if (!parse_number(rest_.substr(0, end), value)) fail("a dimension of the shape is not an integer");
      rest_.remove_prefix(end);
      if (peek() == 'L') accept('L');  // written by Python 2
      values.push_back(value);
      if (!accept(',') && peek() != ')') fail("',' or ')' expected in the shape");
    }
    return values;
  }

  std::string_view rest_;
  const std::filesystem::path& name_;
};

void parse_dtype(Layout& layout, const std::filesystem::path& name) {
  const std::string& dtype = layout.header.dtype;
  const auto refuse = [&] {
    throw_bad_input(name, "descr", "unsupported dtype '" + dtype + "'",
                    "convert it to float16, float32, float64, an integer type or bool");
  };
  if (dtype.size() != 3 || std::string_view("<>|=").find(dtype[0]) == std::string_view::npos) refuse();
  layout.big_endian = dtype[0] == '>' || (dtype[0] == '=' && std::endian::native == std::endian::big);
  layout.kind = dtype[1];
  layout.item_bytes = unsigned(dtype[2] - '0');
  const unsigned n = layout.item_bytes;
  const bool known = (layout.kind == 'f' && (n == 2 || n == 4 || n == 8)) ||
                     ((layout.kind == 'i' || layout.kind == 'u') && (n == 1 || n == 2 || n == 4 || n == 8)) ||
                     (layout.kind == 'b' && n == 1);
  if (!known) refuse();
}

/// `bytes` holds at least the beginning of the file, `file_size` is the whole file's.
Layout parse_layout(std::string_view bytes, uint64_t file_size, const std::filesystem::path& name) {
  constexpr std::string_view kMagic("\x93NUMPY", 6);
  if (bytes.substr(0, kMagic.size()) != kMagic) {
    refuse_foreign_content(bytes, name);
    throw_bad_input(name, "magic", "not a NumPy .npy file", kNpyRemedy);
  }
  ByteReader reader(bytes, name);
  reader.take(kMagic.size(), "magic");
  const int major = reader.little<uint8_t>("version");
  reader.little<uint8_t>("version");
  if (major < 1 || major > 3) {
    throw_bad_input(name, "version", "unsupported format version " + std::to_string(major), kNpyRemedy);
  }
  const uint64_t header_bytes = major == 1 ? reader.little<uint16_t>("header") : reader.little<uint32_t>("header");
  if (header_bytes > kMaxHeaderBytes) throw_bad_input(name, "header", "larger than 1 MiB", kNpyRemedy);

  Layout layout;
  HeaderParser(reader.take(header_bytes, "header"), name).parse(layout);
  parse_dtype(layout, name);
  layout.data_offset = reader.offset();
  layout.count = element_count(layout.header.shape, layout.item_bytes, name, "shape");
  const uint64_t needed = layout.count * layout.item_bytes, present = file_size - layout.data_offset;
  if (needed != present) {
    throw_bad_input(name, "shape",
                    shape_text(layout.header.shape) + " of " + layout.header.dtype + " needs " +
                        std::to_string(needed) + " bytes of data, the file has " + std::to_string(present),
                    kDamagedFileRemedy);
  }
  return layout;
}

/// Begin of the data, as far as the first bytes of a file tell.
uint64_t header_end(std::string_view bytes) {
  if (bytes.size() < 12) return 12;
  return bytes[6] == 1 ? 10 + uint64_t(load_number<uint16_t>(bytes.data() + 8, false))
                       : 12 + uint64_t(load_number<uint32_t>(bytes.data() + 8, false));
}

template <class Convert>
std::vector<float> convert_items(const Layout& layout, const char* data, Convert&& convert) {
  std::vector<float> values(layout.count);
  if (!layout.fortran_order) {
    for (uint64_t i = 0; i < layout.count; ++i) values[i] = convert(data + i * layout.item_bytes);
    return values;
  }
  std::vector<int64_t> strides(layout.header.shape.size());
  int64_t stride = 1;
  for (size_t axis = 0; axis < strides.size(); ++axis) {
    strides[axis] = stride;
    stride *= std::max<int64_t>(layout.header.shape[axis], 1);
  }
  size_t next = 0;
  for_each_strided(layout.header.shape, strides, 0,
                   [&](uint64_t i) { values[next++] = convert(data + i * layout.item_bytes); });
  return values;
}

template <class T>
std::vector<float> convert_numbers(const Layout& layout, const char* data) {
  const bool big = layout.big_endian;
  return convert_items(layout, data, [big](const char* p) { return static_cast<float>(load_number<T>(p, big)); });
}

std::vector<float> convert(const Layout& layout, const char* data) {
  const bool big = layout.big_endian;
  switch (layout.kind) {
    case 'f':
      if (layout.item_bytes == 8) return convert_numbers<double>(layout, data);
      if (layout.item_bytes == 4) return convert_numbers<float>(layout, data);
      return convert_items(layout, data, [big](const char* p) { return half_to_float(load_number<uint16_t>(p, big)); });
    case 'i':
      if (layout.item_bytes == 8) return convert_numbers<int64_t>(layout, data);
      if (layout.item_bytes == 4) return convert_numbers<int32_t>(layout, data);
      if (layout.item_bytes == 2) return convert_numbers<int16_t>(layout, data);
      return convert_numbers<int8_t>(layout, data);
    case 'u':
      if (layout.item_bytes == 8) return convert_numbers<uint64_t>(layout, data);
      if (layout.item_bytes == 4) return convert_numbers<uint32_t>(layout, data);
      if (layout.item_bytes == 2) return convert_numbers<uint16_t>(layout, data);
      return convert_numbers<uint8_t>(layout, data);
    default:
      return convert_items(layout, data, [](const char* p) { return *p != 0 ? 1.0f : 0.0f; });
  }
}

/// The bytes before the data.
std::string header_for(const char* dtype, const std::vector<int64_t>& shape) {
  std::string dimensions;
  for (const int64_t n : shape) dimensions += std::to_string(n) + ", ";
  if (shape.size() > 1) dimensions.resize(dimensions.size() - 2);
  if (shape.size() == 1) dimensions.pop_back();
  std::string header =
      std::string("{'descr': '") + dtype + "', 'fortran_order': False, 'shape': (" + dimensions + "), }";
  constexpr size_t kPreamble = 10, kAlignment = 64;  // bytes; the data start on a multiple of 64
  header.append((kAlignment - (kPreamble + header.size() + 1) % kAlignment) % kAlignment, ' ');
  header += '\n';
  std::string out("\x93NUMPY\x01\x00", 8);
  append_little(out, static_cast<uint16_t>(header.size()));
  return out + header;
}

/// Hands header and data to `write(pointer, bytes)`.
template <class T, class Write>
void encode_npy(const std::filesystem::path& name, const char* dtype, const std::vector<int64_t>& shape, const T* data,
                Write&& write) {
  const uint64_t count = element_count(shape, sizeof(T), name, "shape");
  const std::string header = header_for(dtype, shape);
  write(header.data(), header.size());
  if constexpr (std::endian::native == std::endian::little) {
    write(reinterpret_cast<const char*>(data), count * sizeof(T));
  } else {
    std::string swapped;
    for (uint64_t i = 0; i < count; ++i) append_little(swapped, data[i]);
    write(swapped.data(), swapped.size());
  }
}

template <class T>
void write_npy(const std::filesystem::path& path, const char* dtype, const std::vector<int64_t>& shape, const T* data) {
  AtomicFile file(path);
  encode_npy(path, dtype, shape, data, [&](const char* bytes, size_t count) { file.write(bytes, count); });
  file.commit();
}

}  // namespace

ArrayHeader read_npy_header(const std::filesystem::path& path) {
  require_no_waiting(path);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);
  if (!file || error) throw_bad_input(path, "", cannot_open(errno), "check the path");
  constexpr size_t kUsualBytes = 4096,
                   kPreamble = 12;  // 12 bytes precede the header of versions 2 and 3
  std::string prefix;
  for (const size_t wanted : {kUsualBytes, kMaxHeaderBytes + kPreamble}) {
    const size_t have = prefix.size();
    prefix.resize(std::min<uint64_t>(size, wanted));
    file.read(prefix.data() + have, static_cast<std::streamsize>(prefix.size() - have));
    prefix.resize(have + static_cast<size_t>(file.gcount()));
    if (prefix.size() < wanted || header_end(prefix) <= prefix.size()) break;
  }
  return parse_layout(prefix, size, path).header;
}

ArrayHeader decode_npy_header(std::string_view beginning, uint64_t size, const std::filesystem::path& name_for_errors) {
  return parse_layout(beginning, size, name_for_errors).header;
}

FloatArray decode_npy(const std::string& bytes, const std::filesystem::path& name_for_errors) {
  const Layout layout = parse_layout(bytes, bytes.size(), name_for_errors);
  return {layout.header.shape, convert(layout, bytes.data() + layout.data_offset)};
}

FloatArray read_npy(const std::filesystem::path& path) { return decode_npy(read_file(path), path); }

void write_npy_float32(const std::filesystem::path& path, const std::vector<int64_t>& shape, const float* data) {
  write_npy(path, "<f4", shape, data);
}

void write_npy_float16(const std::filesystem::path& path, const std::vector<int64_t>& shape, const uint16_t* data) {
  write_npy(path, "<f2", shape, data);
}

std::string encode_npy_float16(const std::filesystem::path& name_for_errors, const std::vector<int64_t>& shape,
                               const uint16_t* data) {
  std::string out;
  encode_npy(name_for_errors, "<f2", shape, data, [&](const char* bytes, size_t count) { out.append(bytes, count); });
  return out;
}

}  // namespace aligngs
