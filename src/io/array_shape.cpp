#include "io/array_shape.h"

#include <limits>

#include "core/error.h"

namespace aligngs {

uint64_t element_count(const std::vector<int64_t>& shape, uint64_t element_bytes, const std::filesystem::path& name,
                       const std::string& field) {
  constexpr const char* kRemedy = "the file is damaged or no array: write it again, or get it again";
  constexpr size_t kMaxDimensions = 64;  // NumPy's own limit
  if (shape.size() > kMaxDimensions) throw_bad_input(name, field, "more than 64 dimensions", kRemedy);
  uint64_t product = element_bytes;  // of the non-zero dimensions: (0, 2^62, 2^62) is refused as well
  bool empty = false;
  for (const int64_t n : shape) {
    if (n < 0) throw_bad_input(name, field, "negative dimension in " + shape_text(shape), kRemedy);
    if (n == 0) {
      empty = true;
    } else if (product > uint64_t(std::numeric_limits<int64_t>::max()) / uint64_t(n)) {
      throw_bad_input(name, field, "the shape " + shape_text(shape) + " is too large", kRemedy);
    } else {
      product *= uint64_t(n);
    }
  }
  return empty ? 0 : product / element_bytes;
}

std::string shape_text(const std::vector<int64_t>& shape) {
  std::string text = "(";
  for (size_t i = 0; i < shape.size(); ++i) text += (i ? ", " : "") + std::to_string(shape[i]);
  return text + ")";
}

}  // namespace aligngs
