// Flat tensors of a checkpoint.
#pragma once

#include <cstring>
#include <filesystem>
#include <vector>

#include "core/error.h"
#include "io/safetensors.h"

namespace aligngs {

template <class T>
TensorBytes raw_tensor(const char* dtype, const T* values, size_t count) {
  TensorBytes t;
  t.dtype = dtype;
  t.shape = {static_cast<int64_t>(count)};
  t.bytes.resize(count * sizeof(T));
  if (count > 0) std::memcpy(t.bytes.data(), values, t.bytes.size());
  return t;
}

/// Error{kBadInput} when there is no tensor of this name and type.
template <class T>
std::vector<T> raw_values(const TensorFile& file, const char* name, const char* dtype,
                          const std::filesystem::path& path) {
  const auto it = file.tensors.find(name);
  if (it == file.tensors.end() || it->second.dtype != dtype || it->second.bytes.size() % sizeof(T) != 0) {
    throw_bad_input(path, name, "the tensor is missing or of another type");
  }
  std::vector<T> values(it->second.bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), it->second.bytes.data(), it->second.bytes.size());
  return values;
}

}  // namespace aligngs
