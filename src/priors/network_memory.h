// Memory of a network, from the shapes of its weights and the size of what it is
// shown: asked before any weight is loaded.
#pragma once

#include <cstdint>

#include "core/memory_budget.h"
#include "nn/compute.h"
#include "nn/segmentation.h"
#include "nn/weights.h"

namespace aligngs {

/// Pixels of an image or of a window.
struct NetworkInput {
  int64_t width = 0, height = 0;
};

struct NetworkMemoryOptions {
  nn::Precision precision = nn::Precision::kFloat32;
  int threads = 1;
};

/// ViT-Adapter + Mask2Former on one window.
void add_mask2former_memory(MemoryBudget& budget, const nn::Weights& weights, const NetworkInput& window,
                            const NetworkMemoryOptions& options);
/// DINOv2 with a linear or multi-scale segmentation head on one window.
void add_bn_head_memory(MemoryBudget& budget, const nn::Weights& backbone, const nn::Weights& head,
                        const NetworkInput& window, const NetworkMemoryOptions& options);
/// DINOv2 with a DPT or a linear depth head on one image.
void add_depth_network_memory(MemoryBudget& budget, const nn::Weights& backbone, const nn::Weights& head,
                              const NetworkInput& image, const NetworkMemoryOptions& options);

/// EoMT on a photo whose long side is `aspect` times the short one. `weights`: nn::eomt_weights().
void add_eomt_memory(MemoryBudget& budget, const nn::Weights& weights, double aspect,
                     const NetworkMemoryOptions& options);
/// LingBot-Vision on one window. `weights`: nn::lingbot_weights().
void add_lingbot_memory(MemoryBudget& budget, const nn::Weights& weights, const NetworkInput& window,
                        const NetworkMemoryOptions& options);

/// The largest image that `plan` makes of a photo, and the part of it that the network sees at
/// once.
NetworkInput largest_planned_image(const nn::SegmentationPlan& plan, int photo_width, int photo_height);
NetworkInput planned_window(const nn::SegmentationPlan& plan, const NetworkInput& image);
/// The values of all classes of such an image, where it takes several windows.
void add_sliding_memory(MemoryBudget& budget, const nn::SegmentationPlan& plan, const NetworkInput& image,
                        int64_t classes);

}  // namespace aligngs
