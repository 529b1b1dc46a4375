// Shapes of arrays as stored in files: checked products and memory order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace aligngs {

/// Number of elements of a shape. Error{kBadInput} for a negative dimension, more than 64
/// dimensions, or when the product of the non-zero dimensions times `element_bytes` does not fit in
/// 63 bits.
uint64_t element_count(const std::vector<int64_t>& shape, uint64_t element_bytes, const std::filesystem::path& name,
                       const std::string& field);

/// "(3, 4)".
std::string shape_text(const std::vector<int64_t>& shape);

/// Calls visit(source index) for every element in C order of `shape`, where the element (i0, i1,
/// ...) lies at offset + sum(i_k * strides_k) of the source. Strides are in elements.
template <class Visit>
void for_each_strided(const std::vector<int64_t>& shape, const std::vector<int64_t>& strides, uint64_t offset,
                      Visit&& visit) {
  for (const int64_t n : shape) {
    if (n == 0) return;
  }
  std::vector<int64_t> index(shape.size(), 0);
  uint64_t position = offset;
  while (true) {
    visit(position);
    size_t axis = shape.size();
    while (axis > 0) {
      --axis;
      if (++index[axis] < shape[axis]) {
        position += static_cast<uint64_t>(strides[axis]);
        break;
      }
      position -= static_cast<uint64_t>(strides[axis]) * static_cast<uint64_t>(shape[axis] - 1);
      index[axis] = 0;
      if (axis == 0) return;
    }
    if (shape.empty()) return;
  }
}

}  // namespace aligngs
