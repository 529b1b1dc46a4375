// Inputs of the semantic loss from a training view that do not change between steps.
#pragma once

#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "engine/training_view.h"

namespace aligngs {

/// Values of the teacher as sampled at the image's pixels, 6 bytes per pixel. Neither its logarithms nor its arg-max
/// are computed twice.
struct SemanticView {
  std::vector<float> negative_entropy;  ///< [H * W] sum t log t
  std::vector<uint16_t> top_class;      ///< [H * W] arg-max of t, kNoLabel where the pixel is not valid
  size_t valid = 0;                     ///< pixels that take part in the semantic loss
  bool ready = false;
};

/// Fills `out` from the view's teacher, which must not be empty. Defined beside the sampling of the CPU engine, in
/// engine/cpu/semantic_block.cpp; an engine on a device takes the result.
/// The arg-max is taken over the first `classes` channels.
void prepare_semantic_view(const TrainingView& view, int classes, ThreadPool& pool, SemanticView& out);

}  // namespace aligngs
