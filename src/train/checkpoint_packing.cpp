#include "train/checkpoint_packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/gzip.h"
#include "train/sparse_floats.h"

namespace aligngs {
namespace {

const std::string kPackedPrefix = "gzip.", kSparsePrefix = "sparse.";
constexpr size_t kLeastBytes = size_t(1) << 16;  // below, the names cost as much as is gained
constexpr int kLevel = 1;                        // level 9 takes ten times as long for a fifth less
constexpr uint64_t kMostPerByte = 1100;          // deflate gives at most 1032 bytes for one
constexpr uint64_t kMostPerBit = 32;             // bytes of floats for each byte of sparse bits

uint64_t bytes_of_type(const std::string& type) {
  return type == "U8" || type == "I8" ? 1 : type == "F32" ? 4 : type == "F64" || type == "I64" || type == "U64" ? 8 : 0;
}

bool begins_with(const std::string& name, const std::string& prefix) {
  return name.compare(0, prefix.size(), prefix) == 0;
}

std::string_view text_of(const std::vector<uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string description_of(const TensorBytes& tensor) {
  std::string text = tensor.dtype;
  for (const int64_t size : tensor.shape) text += fmt::format(" {}", size);
  return text;
}

/// Type and shape from "F32 1000 150"; no type when the text is malformed or means more bytes than `most`.
TensorBytes described(std::istream& in, uint64_t most) {
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

struct Packed {
  std::string prefix, description, stream;
};

Packed packed(const TensorBytes& tensor) {
  if (tensor.dtype == "F32") {
    if (const std::optional<SparseFloats> sparse = sparse_floats(text_of(tensor.bytes)))
      return {kSparsePrefix, fmt::format("{} {}", sparse->common, description_of(tensor)),
              gzip_compressed(sparse->bytes, kLevel)};
  }
  return {kPackedPrefix, description_of(tensor), gzip_compressed(text_of(tensor.bytes), kLevel)};
}

/// Error{kBadInput} for a malformed description, and where the stream does not fit it.
TensorBytes expanded(const std::string& name, const std::string& description, const TensorBytes& stream,
                     const std::filesystem::path& path) {
  std::istringstream text(description);
  const bool sparse = begins_with(name, kSparsePrefix);
  uint32_t common = 0;
  if (sparse) text >> common;
  TensorBytes out = described(text, kMostPerByte * (sparse ? kMostPerBit : 1) * stream.bytes.size());
  if (out.bytes.empty() || (sparse && out.dtype != "F32"))
    throw_bad_input(path, name, "the type or the shape of the packed tensor is missing or malformed");
  const size_t count = out.bytes.size() / sizeof(float);
  const std::string bytes =
      gzip_expanded(text_of(stream.bytes), path, sparse ? most_sparse_bytes(count) : out.bytes.size());
  if (sparse ? !expand_sparse_floats(common, bytes, count, out.bytes.data()) : bytes.size() != out.bytes.size())
    throw_bad_input(path, name, "the packed tensor has another size than its shape");
  if (!sparse) std::copy(bytes.begin(), bytes.end(), out.bytes.begin());
  return out;
}

}  // namespace

void pack_tensors(TensorFile& file) {
  std::map<std::string, TensorBytes> tensors;
  for (auto& [name, tensor] : file.tensors) {
    if (tensor.bytes.size() >= kLeastBytes) {
      const Packed small = packed(tensor);
      if (small.stream.size() < tensor.bytes.size()) {
        file.metadata[small.prefix + name] = small.description;
        tensors[small.prefix + name] = {
            "U8", {static_cast<int64_t>(small.stream.size())}, {small.stream.begin(), small.stream.end()}};
        continue;
      }
    }
    tensors[name] = std::move(tensor);
  }
  file.tensors = std::move(tensors);
}

void unpack_tensors(TensorFile& file, const std::filesystem::path& path) {
  std::map<std::string, TensorBytes> plain;
  for (auto& [name, tensor] : file.tensors) {
    const std::string* prefix = begins_with(name, kPackedPrefix)   ? &kPackedPrefix
                                : begins_with(name, kSparsePrefix) ? &kSparsePrefix
                                                                   : nullptr;
    if (!prefix) {
      plain[name] = std::move(tensor);
      continue;
    }
    const auto text = file.metadata.find(name);
    plain[name.substr(prefix->size())] = expanded(name, text == file.metadata.end() ? "" : text->second, tensor, path);
    file.metadata.erase(name);
  }
  file.tensors = std::move(plain);
}

}  // namespace aligngs
