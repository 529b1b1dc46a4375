#include "io/safetensors_stream.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/half.h"
#include "io/array_shape.h"
#include "io/byte_reader.h"
#include "io/safetensors.h"

namespace aligngs {

SafetensorsStream::SafetensorsStream(const std::filesystem::path& path, const std::vector<Entry>& entries,
                                     const std::string& dtype, const std::map<std::string, std::string>& metadata)
    : out_(path), path_(path), half_(dtype == "F16") {
  if (!half_ && dtype != "F32")
    throw Error({ErrorKind::kFailed, "cannot write tensors of type " + dtype, path, "dtype", ""});
  const unsigned bytes = safetensors_item_bytes(dtype);
  nlohmann::ordered_json header = nlohmann::ordered_json::object();
  if (!metadata.empty()) header["__metadata__"] = metadata;
  uint64_t offset = 0;
  for (const Entry& entry : entries) {
    const uint64_t count = element_count(entry.shape, bytes, path, entry.name);
    const uint64_t end = offset + count * bytes;
    header[entry.name] = {{"dtype", dtype}, {"shape", entry.shape}, {"data_offsets", {offset, end}}};
    offset = end;
    missing_ += count;
  }
  std::string text = header.dump();
  constexpr size_t kAlignment = 8;
  text.append((kAlignment - text.size() % kAlignment) % kAlignment, ' ');
  std::string length;
  append_little(length, static_cast<uint64_t>(text.size()));
  out_.write(length);
  out_.write(text);
}

void SafetensorsStream::append(const float* values, uint64_t count) {
  if (count > missing_) throw Error({ErrorKind::kFailed, "more values than the header announces", path_, "", ""});
  missing_ -= count;
  constexpr uint64_t kChunk = uint64_t(1) << 16;  // values converted at a time
  std::string bytes;
  for (uint64_t begin = 0; begin < count; begin += kChunk) {
    bytes.clear();
    for (uint64_t i = begin; i < std::min(count, begin + kChunk); ++i) {
      if (half_) {
        append_little(bytes, float_to_half(values[i]));
      } else {
        append_little(bytes, values[i]);
      }
    }
    out_.write(bytes);
  }
}

void SafetensorsStream::commit() {
  if (missing_ > 0) {
    throw Error({ErrorKind::kFailed, std::to_string(missing_) + " values are missing", path_, "", ""});
  }
  out_.commit();
}

}  // namespace aligngs
