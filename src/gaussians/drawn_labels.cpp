#include "gaussians/drawn_labels.h"

#include <algorithm>
#include <cmath>

#include "gaussians/object_labels.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

// probability of a class that is not among the kept ones: next to none once it is raised to a power
constexpr float kLeast = 1e-4f;
constexpr size_t kDrawnGrain = 2048;  // Gaussians per task

}  // namespace

void sharpen_label_rows(GaussianModel& model, double extent, double sharpness, ThreadPool& pool) {
  if (model.semantic_channels == 0 || model.size() == 0) return;
  sharpen_label_rows(model, smoothed_labels(model, extent, pool), sharpness, pool);
}

void sharpen_label_rows(GaussianModel& model, const SoftLabels& soft, double sharpness, ThreadPool& pool) {
  const size_t channels = static_cast<size_t>(model.semantic_channels);
  const float power = static_cast<float>(sharpness), least = power * std::log(kLeast);
  pool.parallel_for(model.size(), kDrawnGrain, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      float* row = &model.semantics[i * channels];
      const uint16_t* label = &soft.label[i * SoftLabels::kTop];
      const float* probability = &soft.probability[i * SoftLabels::kTop];
      std::fill_n(row, channels, label[0] == kNoLabel ? 0.0f : least);
      for (size_t k = 0; k < SoftLabels::kTop && label[k] != kNoLabel; ++k)
        row[label[k]] = power * std::log(std::max(probability[k], kLeast));
    }
  });
}

}  // namespace aligngs
