#include "scene/semantic_target.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/half.h"
#include "core/target_clones.h"
#include "core/vector_lanes.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

/// Turns the C values of one pixel into probabilities; returns the confidence.
float softmax(float* v, int channels) {
  const float largest = *std::max_element(v, v + channels);
  double sum = 0;
  for (int c = 0; c < channels; ++c) {
    v[c] = std::exp(v[c] - largest);
    sum += v[c];
  }
  const float scale = static_cast<float>(1 / sum);
  for (int c = 0; c < channels; ++c) v[c] *= scale;
  return 1;
}

float normalise_scores(float* v, int channels, double gamma, double least_sum, float& score_sum) {
  double raw = 0, sum = 0;
  for (int c = 0; c < channels; ++c) {
    v[c] = std::max(v[c], 0.0f);
    raw += v[c];
    if (gamma != 1) v[c] = static_cast<float>(std::pow(static_cast<double>(v[c]), gamma));
    sum += v[c];
  }
  if (!(sum > 0)) {
    std::fill(v, v + channels, 1.0f / static_cast<float>(channels));
    return 0;
  }
  const double scale = 1 / sum;
  for (int c = 0; c < channels; ++c) v[c] = static_cast<float>(v[c] * scale);
  score_sum = static_cast<float>(std::min(raw, 1.0));
  return raw < least_sum ? 0.0f : 1.0f;
}

/// `score_sum` stays 0 where nothing is known.
float convert(float* v, int channels, const SemanticConversion& conversion, float& score_sum) {
  if (!std::all_of(v, v + channels, [](float x) { return std::isfinite(x); })) {
    std::fill(v, v + channels, 1.0f / static_cast<float>(channels));
    return 0;
  }
  if (conversion.kind == SemanticKind::kLogits) {
    score_sum = 1;
    return softmax(v, channels);
  }
  const bool scores = conversion.kind == SemanticKind::kScores;
  const float confidence =
      normalise_scores(v, channels, scores ? conversion.score_gamma : 1, conversion.least_score_sum, score_sum);
  if (!scores && score_sum > 0) score_sum = 1;
  return confidence;
}

/// Source row or column pair of an output coordinate: (i + 0.5) * source / target - 0.5, clamped at the border.
struct Sample {
  int low, high;
  float weight;  ///< of `high`
  Sample(int i, int source, int target) {
    const double s = std::clamp((i + 0.5) * source / target - 0.5, 0.0, source - 1.0);
    low = static_cast<int>(s);
    high = std::min(low + 1, source - 1);
    weight = static_cast<float>(s - low);
  }
};

ALIGNGS_TARGET_CLONES void scale_halves(const uint16_t* halves, float factor, size_t count, float* out) {
  for (size_t i = 0; i < count; ++i) out[i] = factor * half_to_float(halves[i]);
}

ALIGNGS_TARGET_CLONES void blend(const float* low, const float* high, float weight, size_t count, float* out) {
  for (size_t i = 0; i < count; ++i) out[i] = low[i] * (1 - weight) + high[i] * weight;
}

/// The first of the largest values of the blend of two rows.
ALIGNGS_TARGET_CLONES size_t largest_of_blend(const float* low, const float* high, float weight, size_t count) {
  typedef int32_t IndexLanes __attribute__((vector_size(kLanes * sizeof(int32_t))));
  const float rest = 1 - weight;
  FloatLanes best = FloatLanes{} - std::numeric_limits<float>::infinity();
  IndexLanes index{};
  size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    FloatLanes a, b;
    std::memcpy(&a, low + i, sizeof(a));
    std::memcpy(&b, high + i, sizeof(b));
    const FloatLanes value = a * rest + b * weight;
    const auto larger = value > best;
    best = larger ? value : best;
    index = larger ? IndexLanes{} + static_cast<int32_t>(i) : index;
  }
  float most = -std::numeric_limits<float>::infinity();
  size_t found = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    const size_t at = static_cast<size_t>(index[lane]) + static_cast<size_t>(lane);
    if (best[lane] > most || (best[lane] == most && at < found)) {
      most = best[lane];
      found = at;
    }
  }
  for (; i < count; ++i) {
    const float value = low[i] * rest + high[i] * weight;
    if (value > most) {
      most = value;
      found = i;
    }
  }
  return found;
}

/// Rows of the target as float, multiplied by confidence; keeps the two used last.
class RowCache {
 public:
  explicit RowCache(const SemanticTarget& target) : target_(target) {}

  const std::vector<float>& row(int y) {
    Row& slot = rows_[y & 1];
    if (slot.y == y) return slot.values;
    slot.y = y;
    const size_t width = static_cast<size_t>(target_.width), channels = static_cast<size_t>(target_.channels);
    slot.values.resize(width * channels);
    const uint16_t* source = &target_.probabilities[y * width * channels];
    for (size_t x = 0; x < width; ++x) {
      const size_t pixel = y * width + x;
      const float confidence = target_.confidence[pixel] * (target_.scale.empty() ? 1.0f : target_.scale[pixel]);
      scale_halves(source + x * channels, confidence, channels, &slot.values[x * channels]);
    }
    return slot.values;
  }

 private:
  struct Row {
    int y = -1;
    std::vector<float> values;
  };
  const SemanticTarget& target_;
  Row rows_[2];
};

}  // namespace

SemanticTarget semantic_target(const float* values, int channels, int width, int height,
                               const SemanticConversion& conversion) {
  SemanticTarget out;
  out.channels = channels;
  out.width = width;
  out.height = height;
  const size_t pixels = static_cast<size_t>(width) * height;
  out.probabilities.resize(pixels * channels);
  out.confidence.resize(pixels);
  out.score_sum.assign(pixels, 0.0f);
  std::vector<float> row(static_cast<size_t>(width) * channels);
  for (int y = 0; y < height; ++y) {
    for (int c = 0; c < channels; ++c) {  // planar to interleaved, one row at a time: stays in cache
      const float* plane = values + c * pixels + static_cast<size_t>(y) * width;
      for (int x = 0; x < width; ++x) row[static_cast<size_t>(x) * channels + c] = plane[x];
    }
    for (int x = 0; x < width; ++x) {
      float* v = &row[static_cast<size_t>(x) * channels];
      const size_t pixel = static_cast<size_t>(y) * width + x;
      out.confidence[pixel] = convert(v, channels, conversion, out.score_sum[pixel]);
      uint16_t* half = &out.probabilities[pixel * channels];
      for (int c = 0; c < channels; ++c) half[c] = float_to_half(v[c]);
    }
  }
  normalise_target(out);
  return out;
}

void normalise_target(SemanticTarget& target) {
  const size_t pixels = static_cast<size_t>(target.width) * target.height,
               channels = static_cast<size_t>(target.channels);
  target.scale.resize(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    double sum = 0;
    for (size_t c = 0; c < channels; ++c)
      sum += static_cast<double>(half_to_float(target.probabilities[i * channels + c]));
    target.scale[i] = sum > 0 && std::isfinite(sum) ? static_cast<float>(1 / sum) : 1.0f;
  }
}

Image<uint16_t> target_labels(const SemanticTarget& target, int width, int height) {
  Image<uint16_t> labels(width, height, 1, kNoLabel);
  if (target.empty()) return labels;
  const int channels = target.channels;
  RowCache cache(target);
  std::vector<float> blended(static_cast<size_t>(target.width) * channels);
  std::vector<float> confidence(target.width);
  for (int y = 0; y < height; ++y) {
    const Sample v(y, target.height, height);
    const std::vector<float>& top = cache.row(v.low);
    const std::vector<float>& bottom = cache.row(v.high);
    blend(top.data(), bottom.data(), v.weight, blended.size(), blended.data());
    for (int x = 0; x < target.width; ++x) {
      const size_t stride = target.width;
      confidence[x] =
          target.confidence[v.low * stride + x] * (1 - v.weight) + target.confidence[v.high * stride + x] * v.weight;
    }
    for (int x = 0; x < width; ++x) {
      const Sample h(x, target.width, width);
      if (confidence[h.low] * (1 - h.weight) + confidence[h.high] * h.weight < 0.5f) continue;
      const float* left = &blended[static_cast<size_t>(h.low) * channels];
      const float* right = &blended[static_cast<size_t>(h.high) * channels];
      labels.at(x, y) = static_cast<uint16_t>(largest_of_blend(left, right, h.weight, static_cast<size_t>(channels)));
    }
  }
  return labels;
}

}  // namespace aligngs
