#include "train/checkpoint_packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/gzip.h"

namespace aligngs {
namespace {

const std::string kPackedPrefix = "gzip.";
constexpr size_t kLeastBytes = size_t(1) << 16;  // below, the names cost as much as is gained
constexpr int kLevel = 1;                        // level 9 takes ten times as long for a fifth less
constexpr uint64_t kMostPerByte = 1100;          // deflate gives at most 1032 bytes for one

uint64_t bytes_of_type(const std::string& type) {
  return type == "U8" ? 1 : type == "F32" ? 4 : type == "F64" || type == "I64" || type == "U64" ? 8 : 0;
}

/// Type and shape from "F32 1000 150"; no type when the text is malformed or means more bytes than `most`.
TensorBytes described(const std::string& text, uint64_t most) {
  std::istringstream in(text);
  TensorBytes tensor;
  in >> tensor.dtype;
  uint64_t bytes = bytes_of_type(tensor.dtype);
  for (int64_t size = 0; in >> size;) {
    if (size <= 0 || bytes > most / static_cast<uint64_t>(size)) return {};
    bytes *= static_cast<uint64_t>(size);
    tensor.shape.push_back(size);
  }
  if (!in.eof() || bytes == 0 || tensor.shape.empty()) return {};
  tensor.bytes.resize(bytes);
  return tensor;
}

}  // namespace

void pack_tensors(TensorFile& file) {
  std::map<std::string, TensorBytes> packed;
  for (auto& [name, tensor] : file.tensors) {
    if (tensor.bytes.size() >= kLeastBytes) {
      const std::string stream =
          gzip_compressed({reinterpret_cast<const char*>(tensor.bytes.data()), tensor.bytes.size()}, kLevel);
      if (stream.size() < tensor.bytes.size()) {
        std::string description = tensor.dtype;
        for (const int64_t size : tensor.shape) description += fmt::format(" {}", size);
        file.metadata[kPackedPrefix + name] = description;
        packed[kPackedPrefix + name] = {"U8", {static_cast<int64_t>(stream.size())}, {stream.begin(), stream.end()}};
        continue;
      }
    }
    packed[name] = std::move(tensor);
  }
  file.tensors = std::move(packed);
}

void unpack_tensors(TensorFile& file, const std::filesystem::path& path) {
  std::map<std::string, TensorBytes> plain;
  for (auto& [name, tensor] : file.tensors) {
    if (name.compare(0, kPackedPrefix.size(), kPackedPrefix) != 0) {
      plain[name] = std::move(tensor);
      continue;
    }
    const auto text = file.metadata.find(name);
    TensorBytes out = described(text == file.metadata.end() ? "" : text->second, kMostPerByte * tensor.bytes.size());
    if (out.bytes.empty())
      throw_bad_input(path, name, "the type or the shape of the packed tensor is missing or malformed");
    const std::string bytes = gzip_expanded({reinterpret_cast<const char*>(tensor.bytes.data()), tensor.bytes.size()},
                                            path, out.bytes.size());
    if (bytes.size() != out.bytes.size())
      throw_bad_input(path, name, "the packed tensor has another size than its shape");
    std::copy(bytes.begin(), bytes.end(), out.bytes.begin());
    plain[name.substr(kPackedPrefix.size())] = std::move(out);
    file.metadata.erase(name);
  }
  file.tensors = std::move(plain);
}

}  // namespace aligngs
