// The semantic loss of one block, in place on the blended rows; formulas of engine/formulas/semantic_loss.h.
#pragma once

#include "engine/cpu/aligned_array.h"
#include "engine/cpu/semantic_view.h"
#include "engine/cpu/tile_weights.h"
#include "engine/settings.h"

namespace aligngs::cpu {

/// Constant over one step.
struct SemanticStep {
  const TrainingView* view = nullptr;
  const SemanticView* cache = nullptr;
  const LossSettings* losses = nullptr;
  int channels = 0;
  size_t padded = 0;    ///< channels rounded up, tile_products.h
  bool couple = false;  ///< the coupling direction is wanted
};

/// Scratch of one thread.
struct SemanticBlock {
  AlignedArray<float> blended;     ///< [64][padded] in: W^T S; out: row gradient g, zero at pixels without a loss
  AlignedArray<float> direction;   ///< [64][padded] coupling direction h
  AlignedArray<float> transposed;  ///< [padded][64] the same
  AlignedArray<float> teacher;     ///< [padded] of one pixel
  AlignedArray<float> student;     ///< [padded] of one pixel
  alignas(64) float offset[kBlockPixels];  ///< h_0
  double soft = 0, hard = 0;  ///< sums over this block's pixels, not yet divided by the number of valid ones
};

/// True when some pixel of the block has a semantic loss.
bool block_has_teacher(const SemanticStep& step, const BlockWeights& block);

/// Replaces `blended` by the row gradient; with step.couple also fills direction and offset. Sets soft and hard.
void semantic_block_loss(const SemanticStep& step, const BlockWeights& block, SemanticBlock& scratch);

/// The teacher's float32 probabilities at image pixel (x, y), zero-padded; false where the pixel is not valid, and
/// `teacher` is then unspecified.
bool sample_teacher_padded(const SemanticStep& step, int x, int y, float* teacher);

}  // namespace aligngs::cpu
