#include "scene/confidence_file.h"

#include <vector>

#include "core/half.h"
#include "io/npy.h"

namespace aligngs {

void write_confidence(const std::filesystem::path& folder, const std::string& name, const ImageF& confidence) {
  std::vector<uint16_t> half;
  half.reserve(confidence.data.size());
  for (const float c : confidence.data) half.push_back(float_to_half(c));
  write_npy_float16(folder / "pred_confidence" / (name + ".npy"), {confidence.height, confidence.width}, half.data());
}

}  // namespace aligngs
