#include "engine/cuda/teacher_maps.h"

#include <algorithm>
#include <vector>

namespace aligngs::cuda {
namespace {

constexpr int kStridePadding = 8;  ///< numbers of 2 bytes in a vector load of 16

int stride_of(int channels) { return (channels + kStridePadding - 1) / kStridePadding * kStridePadding; }

}  // namespace

TeacherMaps::TeacherMaps(DeviceContext& context, const TrainingView& view, const SemanticView& cache) {
  const SemanticTarget& target = view.data.semantics;
  shape_.width = target.width;
  shape_.height = target.height;
  shape_.channels = target.channels;
  shape_.stride = stride_of(target.channels);
  shape_.valid = static_cast<uint32_t>(cache.valid);
  const size_t pixels = size_t(target.width) * target.height, channels = static_cast<size_t>(target.channels);
  std::vector<uint16_t> padded(pixels * static_cast<size_t>(shape_.stride), 0);
  for (size_t i = 0; i < pixels; ++i) {
    std::copy_n(target.probabilities.begin() + static_cast<std::ptrdiff_t>(i * channels), channels,
                padded.begin() + static_cast<std::ptrdiff_t>(i * static_cast<size_t>(shape_.stride)));
  }
  probabilities_.assign(context, padded, "semantic teacher");
  confidence_.assign(context, target.confidence, "semantic teacher");
  scale_.assign(context, target.scale, "semantic teacher");
  negative_entropy_.assign(context, cache.negative_entropy, "semantic teacher");
  top_class_.assign(context, cache.top_class, "semantic teacher");
  weight_.assign(context, view.semantic_weight.data, "semantic teacher");
}

TeacherSpans TeacherMaps::spans() const {
  TeacherSpans s = shape_;
  s.probabilities = probabilities_.span();
  s.confidence = confidence_.span();
  s.scale = scale_.span();
  s.negative_entropy = negative_entropy_.span();
  s.top_class = top_class_.span();
  s.weight = weight_.span();
  return s;
}

uint64_t TeacherMaps::bytes(int channels, size_t teacher_pixels, size_t image_pixels) {
  constexpr uint64_t kPerTeacherPixel = 2 * sizeof(float);                   // confidence, scale
  constexpr uint64_t kPerImagePixel = 2 * sizeof(float) + sizeof(uint16_t);  // entropy, weight, arg-max
  return teacher_pixels * (uint64_t(stride_of(channels)) * sizeof(uint16_t) + kPerTeacherPixel) +
         image_pixels * kPerImagePixel;
}

}  // namespace aligngs::cuda
