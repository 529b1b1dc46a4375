#include "serve/splat_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace aligngs {
namespace {

// Steps: 8-bit colours have 1/255, which is f_dc / 0.282: 1/256 of f_dc is a quarter of that. Most
// harmonics of a room are below 0.05: in steps of 1/128 their bytes reach to 1.
constexpr float kColumnColorStep = 1.0f / 256, kColumnHarmonicStep = 1.0f / 128;
constexpr float kColumnOpacityStep = 1.0f / 16;  // of a logit: at most 0.016 in opacity
constexpr float kColumnScaleStep = 1.0f / 256;   // of a natural logarithm: 0.4 % in size
constexpr float kColumnRotationStep = 1.0f / 127;
constexpr size_t kColorNumbersPerSplat = size_t(3) * kShCoefficients;

std::string numbered(const char* name, size_t k) { return name + std::to_string(k); }

}  // namespace

template <class Number, class Value>
void SplatColumns::add(const std::string& name, const char* type, float step, const Value& value) {
  description_.push_back({{"name", name}, {"type", type}, {"step", step}});
  for (const uint32_t row : rows_) {
    Number number;
    if constexpr (std::is_floating_point_v<Number>) {
      number = value(row);
    } else {
      constexpr float kLow = static_cast<float>(std::numeric_limits<Number>::min()),
                      kHigh = static_cast<float>(std::numeric_limits<Number>::max());
      number = static_cast<Number>(std::lround(std::clamp(value(row) / step, kLow, kHigh)));
    }
    data_.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
}

void SplatColumns::add_positions() {
  const char* axes[3] = {"x", "y", "z"};
  for (size_t k = 0; k < 3; ++k)
    add<float>(axes[k], "f32", 1, [&](uint32_t i) { return model_.positions[3 * size_t(i) + k]; });
}

void SplatColumns::add_colors(size_t harmonics) {
  const std::vector<float>& sh = model_.sh;
  for (size_t k = 0; k < 3; ++k)
    add<int16_t>(numbered("f_dc_", k), "i16", kColumnColorStep,
                 [&](uint32_t i) { return sh[kColorNumbersPerSplat * i + k]; });
  const size_t per_channel = harmonics / 3;
  for (size_t k = 0; k < harmonics; ++k) {
    const size_t at = 3 * (1 + k % per_channel) + k / per_channel;
    add<int8_t>(numbered("f_rest_", k), "i8", kColumnHarmonicStep,
                [&](uint32_t i) { return sh[kColorNumbersPerSplat * i + at]; });
  }
}

void SplatColumns::add_shapes() {
  add<int8_t>("opacity", "i8", kColumnOpacityStep, [&](uint32_t i) { return model_.opacity_logits[i]; });
  for (size_t k = 0; k < 3; ++k)
    add<int16_t>(numbered("scale_", k), "i16", kColumnScaleStep,
                 [&](uint32_t i) { return model_.log_scales[3 * size_t(i) + k]; });
  for (size_t k = 0; k < 4; ++k) {
    add<int8_t>(numbered("rot_", k), "i8", kColumnRotationStep, [&](uint32_t i) {
      const float* r = &model_.rotations[4 * size_t(i)];
      const float length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
      return length > 0 ? r[k] / length : static_cast<float>(k == 0);
    });
  }
}

void SplatColumns::add_labels(const GaussianLabels& labels) {
  add<uint16_t>("label", "u16", 1, [&](uint32_t i) { return static_cast<float>(labels.label[i]); });
  add<uint16_t>("instance", "u16", 1, [&](uint32_t i) { return static_cast<float>(labels.instance[i]); });
  add<uint8_t>("confidence", "u8", 1, [&](uint32_t i) { return static_cast<float>(labels.confidence[i]); });
}

}  // namespace aligngs
