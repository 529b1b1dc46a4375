// The networks at sizes of a few thousand values, with random weights, for tests here and in other modules.
#pragma once

#include <vector>

#include "nn/da3/da3.h"
#include "nn/da3/metric.h"
#include "nn/eomt/eomt.h"
#include "nn/testing/weights.h"

namespace aligngs::nn {

inline Da3Size small_da3_size() {
  Da3Size size;
  size.encoder = {32, 6, false, 0, 4};
  size.heads = 2;
  size.alternate_from = 2;
  size.features = 8;
  size.camera_depth = 1;
  size.levels = {8, 12, 16, 20};
  return size;
}

inline Da3Options small_da3_options() {
  Da3Options options;
  options.trunk.layers = {2, 3, 4, 5};
  options.camera_heads = 4;
  return options;
}

inline Da3MetricSize small_da3_metric_size() {
  Da3MetricSize size;
  size.encoder = {32, 4, false, 0, 4};
  size.features = 8;
  size.levels = {8, 12, 16, 20};
  return size;
}

inline Da3MetricOptions small_da3_metric_options() { return {2, {0, 1, 2, 3}}; }

/// A window of 64 pixels.
inline EomtSize small_eomt_size() {
  EomtSize size;
  size.encoder = {32, 4, false, 4, 4};
  size.queries = 6;
  size.query_blocks = 2;
  size.classes = 5;
  return size;
}

inline LingbotSize small_lingbot_size() {
  LingbotSize size;
  size.encoder = {32, 3, false, 4, 0};
  size.heads = 2;
  size.classes = 5;
  return size;
}

/// Random weights in memory that a network accepts: no masks of training, positive deviations and periods.
inline std::shared_ptr<MemoryWeights> small_weights(const TensorList& tensors, uint64_t seed = 1) {
  const auto file = MemoryWeights::random(tensors, seed);
  for (const SafetensorsStream::Entry& tensor : tensors) {
    const auto ends = [&](const char* const end) { return tensor.name.ends_with(end); };
    size_t count = 1;
    for (const int64_t n : tensor.shape) count *= size_t(n);
    const auto set = [&](const std::vector<float>& values) { file->set(tensor.name, tensor.shape, values); };
    if (ends("attn_mask_probs")) set(std::vector<float>(count, 0.0f));
    if (ends("pixel_mean")) set({0.485f, 0.456f, 0.406f});
    if (ends("pixel_std")) set({0.229f, 0.224f, 0.225f});
    if (ends("bias_mask")) {
      std::vector<float> mask(count, 1.0f);
      std::fill(mask.begin() + std::ptrdiff_t(count / 3), mask.begin() + std::ptrdiff_t(2 * count / 3), 0.0f);
      set(mask);
    }
    if (ends("rope_embed.periods")) {
      std::vector<float> periods(count, 1.0f);
      for (size_t i = 1; i < count; ++i) periods[i] = 3 * periods[i - 1];
      set(periods);
    }
    if (ends("cam_dec.fc_qvec.bias")) set({0, 0, 0, 3});
    if (ends("cam_dec.fc_fov.0.bias")) set({3, 3});
  }
  return file;
}

/// Smooth colours with a little noise.
inline Image<uint8_t> small_photo(int width, int height, uint64_t seed = 1) {
  Image<uint8_t> photo(width, height, 3);
  Random random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c)
        photo.at(x, y, c) = uint8_t(60 + 90 * x / width + 60 * y / height + 20 * c + random.below(20));
    }
  }
  return photo;
}

}  // namespace aligngs::nn
