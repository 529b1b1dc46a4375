// Format: https://huggingface.co/docs/safetensors (8-byte header length, JSON header, data without
// holes)
#include "io/safetensors.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "core/error.h"
#include "core/half.h"
#include "io/array_shape.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/byte_source.h"
#include "io/damaged_file.h"

namespace aligngs {
namespace {

using Json = nlohmann::json;

constexpr uint64_t kMaxTensorHeaderBytes = 100'000'000;  // the reference implementation's limit
// Tensors are converted in pieces that stay in the second-level cache; a multiple of every item
// size.
constexpr uint64_t kPieceBytes = uint64_t(256) << 10;
const char* const kMetadata = "__metadata__";

struct DataType {
  std::string_view name;
  unsigned bytes;
};
constexpr DataType kDataTypes[] = {{"F64", 8}, {"I64", 8}, {"U64", 8},  {"F32", 4},     {"I32", 4},
                                   {"U32", 4}, {"F16", 2}, {"BF16", 2}, {"I16", 2},     {"U16", 2},
                                   {"I8", 1},  {"U8", 1},  {"BOOL", 1}, {"F8_E4M3", 1}, {"F8_E5M2", 1}};

/// 0 for an unknown type.
unsigned item_bytes(std::string_view dtype) {
  for (const DataType& type : kDataTypes) {
    if (type.name == dtype) return type.bytes;
  }
  return 0;
}

/// Parses the header, refusing keys that occur twice in an object (the JSON library would keep the
/// last).
Json parse_header(std::string_view text, const std::filesystem::path& name) {
  constexpr int kMaxDepth = 4;  // header, tensor, shape
  std::vector<std::set<std::string>> keys;
  std::string repeated;
  bool too_deep = false;
  const auto check = [&](int depth, Json::parse_event_t event, Json& value) {
    if (depth > kMaxDepth) too_deep = true;
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end && !keys.empty()) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second) {
      repeated = value.get<std::string>();
    }
    return !too_deep;
  };
  try {
    Json header = Json::parse(text.begin(), text.end(), check);
    if (too_deep || !header.is_object())
      throw_bad_input(name, "header", "not a safetensors header", kDamagedFileRemedy);
    if (!repeated.empty()) throw_bad_input(name, repeated.substr(0, 200), "the name occurs twice", kDamagedFileRemedy);
    return header;
  } catch (const Json::exception&) {
    throw_bad_input(name, "header", "not valid JSON", kDamagedFileRemedy);
  }
}

struct Placement {
  uint64_t begin = 0, end = 0;
  std::string name;
};

Placement parse_tensor(const std::string& tensor_name, const Json& entry, TensorPlace& tensor, uint64_t data_bytes,
                       const std::filesystem::path& name) {
  const std::string field = tensor_name.substr(0, 200);
  const auto fail = [&](const std::string& message) { throw_bad_input(name, field, message, kDamagedFileRemedy); };
  const auto list_of = [&](const char* key) -> const Json& {
    const auto found = entry.find(key);
    if (found == entry.end() || !found->is_array()) fail(std::string(key) + " is missing or not a list");
    for (const Json& value : *found) {
      if (!value.is_number_unsigned() || value.get<uint64_t>() > uint64_t(INT64_MAX)) {
        fail(std::string(key) + " holds what is no size");
      }
    }
    return *found;
  };
  if (!entry.is_object() || entry.size() != 3) fail("dtype, shape and data_offsets expected");
  const auto dtype = entry.find("dtype");
  if (dtype == entry.end() || !dtype->is_string()) fail("dtype is missing");
  tensor.dtype = dtype->get<std::string>();
  const unsigned bytes = item_bytes(tensor.dtype);
  if (bytes == 0) fail("unknown dtype '" + tensor.dtype.substr(0, 40) + "'");
  for (const Json& value : list_of("shape")) tensor.shape.push_back(value.get<int64_t>());
  const Json& offsets = list_of("data_offsets");
  if (offsets.size() != 2) fail("data_offsets needs two numbers");
  Placement place{offsets[0].get<uint64_t>(), offsets[1].get<uint64_t>(), tensor_name};
  if (place.begin > place.end || place.end > data_bytes) fail("data_offsets reach beyond the file");
  if (element_count(tensor.shape, bytes, name, field) * bytes != place.end - place.begin) {
    fail("the shape " + shape_text(tensor.shape) + " of " + tensor.dtype + " does not fill data_offsets");
  }
  return place;
}

/// The tensors must fill the data one after the other, in some order.
void require_no_holes(std::vector<Placement> places, uint64_t data_bytes, const std::filesystem::path& name) {
  std::sort(places.begin(), places.end(), [](const Placement& a, const Placement& b) {
    return a.begin != b.begin ? a.begin < b.begin : a.end < b.end;
  });
  uint64_t position = 0;
  for (const Placement& place : places) {
    if (place.begin != position) {
      throw_bad_input(name, place.name.substr(0, 200),
                      place.begin < position ? "its data overlap another tensor's" : "there is a hole before its data",
                      kDamagedFileRemedy);
    }
    position = place.end;
  }
  if (position != data_bytes) {
    throw_bad_input(name, "data", std::to_string(data_bytes - position) + " bytes belong to no tensor",
                    kDamagedFileRemedy);
  }
}

template <class T>
void convert_numbers(const char* bytes, size_t count, float* out) {
  for (size_t i = 0; i < count; ++i) out[i] = static_cast<float>(load_number<T>(bytes + i * sizeof(T), false));
}

template <float (*kConvert)(uint16_t)>
void convert_halves(const char* bytes, size_t count, float* out) {
  for (size_t i = 0; i < count; ++i) out[i] = kConvert(load_number<uint16_t>(bytes + 2 * i, false));
}

using ConvertToFloats = void (*)(const char* bytes, size_t count, float* out);

/// Error{kBadInput} for types without a conversion.
ConvertToFloats converter_of(const std::string& dtype, const std::filesystem::path& name, const std::string& tensor) {
  if (dtype == "F32") return convert_numbers<float>;
  if (dtype == "F16") return convert_halves<half_to_float>;
  if (dtype == "BF16") return convert_halves<bfloat16_to_float>;
  if (dtype == "F64") return convert_numbers<double>;
  if (dtype == "I64") return convert_numbers<int64_t>;
  if (dtype == "U64") return convert_numbers<uint64_t>;
  if (dtype == "I32") return convert_numbers<int32_t>;
  if (dtype == "U32") return convert_numbers<uint32_t>;
  if (dtype == "I16") return convert_numbers<int16_t>;
  if (dtype == "U16") return convert_numbers<uint16_t>;
  if (dtype == "I8") return convert_numbers<int8_t>;
  if (dtype == "U8" || dtype == "BOOL") return convert_numbers<uint8_t>;
  throw_bad_input(name, tensor, "cannot convert a tensor of type " + dtype + " to float");
}

/// Offsets in the result count from the start of the data.
TensorDirectory parse_directory(std::string_view text, uint64_t data_bytes, const std::filesystem::path& name) {
  const Json header = parse_header(text, name);
  TensorDirectory directory;
  std::vector<Placement> places;
  for (const auto& [key, entry] : header.items()) {
    if (key == kMetadata) {
      if (!entry.is_object()) throw_bad_input(name, kMetadata, "not an object", kDamagedFileRemedy);
      for (const auto& [meta_key, value] : entry.items()) {
        if (!value.is_string())
          throw_bad_input(name, kMetadata, "'" + meta_key + "' is not a string", kDamagedFileRemedy);
        directory.metadata[meta_key] = value.get<std::string>();
      }
    } else {
      TensorPlace& tensor = directory.tensors[key];
      places.push_back(parse_tensor(key, entry, tensor, data_bytes, name));
      tensor.offset = places.back().begin;
      tensor.bytes = places.back().end - places.back().begin;
    }
  }
  require_no_holes(std::move(places), data_bytes, name);
  return directory;
}

uint64_t checked_header_bytes(uint64_t header_bytes, const std::filesystem::path& name) {
  if (header_bytes > kMaxTensorHeaderBytes)
    throw_bad_input(name, "header length", "more than 100 MB", kDamagedFileRemedy);
  return header_bytes;
}

}  // namespace

unsigned safetensors_item_bytes(const std::string& dtype) { return item_bytes(dtype); }

TensorDirectory read_safetensors_directory(const ByteSource& source) {
  constexpr uint64_t kLengthBytes = 8;
  const std::string length = source.read(0, kLengthBytes);
  const uint64_t header_bytes = checked_header_bytes(load_number<uint64_t>(length.data(), false), source.name());
  const std::string header = source.read(kLengthBytes, header_bytes);
  const uint64_t data_offset = kLengthBytes + header_bytes;
  TensorDirectory directory = parse_directory(header, source.size() - data_offset, source.name());
  for (auto& tensor : directory.tensors) tensor.second.offset += data_offset;
  return directory;
}

TensorFile decode_safetensors(const std::string& bytes, const std::filesystem::path& name_for_errors) {
  const std::filesystem::path& name = name_for_errors;
  ByteReader reader(bytes, name);
  const uint64_t header_bytes = checked_header_bytes(reader.little<uint64_t>("header length"), name);
  const std::string_view header = reader.take(header_bytes, "header");
  const std::string_view data = reader.take(reader.remaining(), "data");
  const TensorDirectory directory = parse_directory(header, data.size(), name);

  TensorFile file;
  file.metadata = directory.metadata;
  for (const auto& [key, place] : directory.tensors) {
    const auto begin = data.begin() + std::ptrdiff_t(place.offset);
    file.tensors[key] = {place.dtype, place.shape, {begin, begin + std::ptrdiff_t(place.bytes)}};
  }
  return file;
}

TensorBytes read_tensor(const ByteSource& source, const TensorPlace& place) {
  TensorBytes tensor = {place.dtype, place.shape, std::vector<uint8_t>(place.bytes)};
  source.read_into(place.offset, place.bytes, reinterpret_cast<char*>(tensor.bytes.data()));
  return tensor;
}

TensorFile read_safetensors(const std::filesystem::path& path) {
  const std::unique_ptr<const ByteSource> source = file_source(path);
  const TensorDirectory directory = read_safetensors_directory(*source);
  TensorFile file;
  file.metadata = directory.metadata;
  for (const auto& [key, place] : directory.tensors) file.tensors[key] = read_tensor(*source, place);
  return file;
}

void write_safetensors(const std::filesystem::path& path, const TensorFile& file) {
  // Wide types first, so that every tensor is aligned to its own item size.
  std::vector<const std::pair<const std::string, TensorBytes>*> order;
  for (const auto& tensor : file.tensors) {
    const unsigned bytes = item_bytes(tensor.second.dtype);
    if (bytes == 0 ||
        element_count(tensor.second.shape, bytes, path, tensor.first) * bytes != tensor.second.bytes.size()) {
      throw Error({ErrorKind::kFailed, "the bytes do not fit dtype and shape", path, tensor.first, ""});
    }
    order.push_back(&tensor);
  }
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
    return item_bytes(a->second.dtype) > item_bytes(b->second.dtype);
  });

  nlohmann::ordered_json header = nlohmann::ordered_json::object();
  if (!file.metadata.empty()) header[kMetadata] = file.metadata;
  uint64_t offset = 0;
  for (const auto* tensor : order) {
    const uint64_t end = offset + tensor->second.bytes.size();
    header[tensor->first] = {
        {"dtype", tensor->second.dtype}, {"shape", tensor->second.shape}, {"data_offsets", {offset, end}}};
    offset = end;
  }
  std::string text;
  try {
    text = header.dump();
  } catch (const Json::exception&) {
    throw Error({ErrorKind::kFailed, "a name or metadata value is not UTF-8", path, "header", ""});
  }
  constexpr size_t kAlignment = 8;
  text.append((kAlignment - text.size() % kAlignment) % kAlignment, ' ');
  std::string length;
  append_little(length, static_cast<uint64_t>(text.size()));

  AtomicFile out(path);
  out.write(length);
  out.write(text);
  for (const auto* tensor : order) out.write(tensor->second.bytes.data(), tensor->second.bytes.size());
  out.commit();
}

TensorBytes tensor_of(const std::vector<float>& values, std::vector<int64_t> shape) {
  if (shape.empty()) shape = {static_cast<int64_t>(values.size())};
  if (element_count(shape, sizeof(float), {}, "shape") != values.size()) {
    throw Error({ErrorKind::kFailed,
                 "the shape " + shape_text(shape) + " does not have " + std::to_string(values.size()) + " elements",
                 {},
                 "shape",
                 ""});
  }
  TensorBytes tensor{"F32", std::move(shape), {}};
  tensor.bytes.resize(values.size() * sizeof(float));
  if constexpr (std::endian::native == std::endian::little) {
    if (!values.empty()) std::memcpy(tensor.bytes.data(), values.data(), tensor.bytes.size());
  } else {
    std::string bytes;
    for (const float value : values) append_little(bytes, value);
    tensor.bytes.assign(bytes.begin(), bytes.end());
  }
  return tensor;
}

std::vector<float> floats_of(const TensorBytes& tensor, const std::string& name_for_errors) {
  const ConvertToFloats convert = converter_of(tensor.dtype, {}, name_for_errors);
  std::vector<float> values(tensor.bytes.size() / item_bytes(tensor.dtype));
  convert(reinterpret_cast<const char*>(tensor.bytes.data()), values.size(), values.data());
  return values;
}

std::vector<float> read_floats(const ByteSource& source, const TensorPlace& place, const std::string& name_for_errors) {
  const ConvertToFloats convert = converter_of(place.dtype, source.name(), name_for_errors);
  const size_t bytes = item_bytes(place.dtype);
  std::vector<float> values(place.bytes / bytes);
  std::vector<char> piece(std::min<uint64_t>(kPieceBytes, place.bytes));
  for (uint64_t done = 0; done < place.bytes; done += piece.size()) {
    const size_t count = std::min<uint64_t>(piece.size(), place.bytes - done);
    source.read_into(place.offset + done, count, piece.data());
    convert(piece.data(), count / bytes, values.data() + done / bytes);
  }
  return values;
}

}  // namespace aligngs
