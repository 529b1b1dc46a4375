#include "scene/confidence_file.h"

#include <vector>

#include "core/half.h"
#include "io/npy.h"

namespace aligngs {

void write_confidence_map(const std::filesystem::path& file, const ImageF& confidence) {
  std::vector<uint16_t> half;
  half.reserve(confidence.data.size());
  for (const float c : confidence.data) half.push_back(float_to_half(c));
  write_npy_float16(file, {confidence.height, confidence.width}, half.data());
}

void write_confidence(const std::filesystem::path& folder, const std::string& name, const ImageF& confidence) {
  write_confidence_map(folder / "pred_confidence" / (name + ".npy"), confidence);
}

}  // namespace aligngs
