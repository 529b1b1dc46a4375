// Writing a safetensors file one tensor after the other, for files that do not fit in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "io/atomic_file.h"

namespace aligngs {

class SafetensorsStream {
 public:
  struct Entry {
    std::string name;
    std::vector<int64_t> shape;
  };

  /// Writes the header: all tensors are of one type ("F32" or "F16"), in the given order.
  SafetensorsStream(const std::filesystem::path& path, const std::vector<Entry>& entries, const std::string& dtype,
                    const std::map<std::string, std::string>& metadata = {});

  /// The next values, continuing where the last call ended, across tensors; converted to the type.
  void append(const float* values, uint64_t count);
  /// Error{kFailed} when values are missing. Until then the file does not exist under its name.
  void commit();

 private:
  AtomicFile out_;
  std::filesystem::path path_;
  bool half_ = false;
  uint64_t missing_ = 0;
};

}  // namespace aligngs
