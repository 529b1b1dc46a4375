// One fuzzer input as three files: two 16-bit lengths in front say where it is cut.
#pragma once

#include <algorithm>
#include <array>
#include <string>

#include "io/byte_reader.h"

namespace aligngs {

inline std::array<std::string, 3> split_input(const std::string& bytes) {
  if (bytes.size() < 4) return {bytes, "", ""};
  const size_t first = std::min<size_t>(load_number<uint16_t>(bytes.data(), false), bytes.size() - 4);
  const size_t second = std::min<size_t>(load_number<uint16_t>(bytes.data() + 2, false), bytes.size() - 4 - first);
  return {bytes.substr(4, first), bytes.substr(4 + first, second), bytes.substr(4 + first + second)};
}

inline std::string join_input(const std::string& first, const std::string& second, const std::string& third) {
  std::string bytes;
  append_little(bytes, static_cast<uint16_t>(first.size()));
  append_little(bytes, static_cast<uint16_t>(second.size()));
  return bytes + first + second + third;
}

}  // namespace aligngs
