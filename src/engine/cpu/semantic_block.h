// The semantic loss of one block, in place on the blended rows; formulas of engine/formulas/semantic_loss.h.
#pragma once

#include "engine/cpu/aligned_array.h"
#include "engine/cpu/tile_weights.h"
#include "engine/settings.h"
#include "engine/shared/semantic_view.h"

namespace aligngs::cpu {

/// The number of classes that each channel represents, as vectors over the padded channels. A model may carry the
/// classes that no teacher ranks high as one last channel, the remainder. It represents n classes of equal probability.
/// Its softmax term is n exp(r). Its share of "nothing here" and its floor are n times those of a class.
struct ClassCounts {
  int channels = 0;               ///< channels of the model, remainder included
  int remainder = 0;              ///< n; 0: every channel is a class of its own
  AlignedArray<float> count;      ///< [padded] 1, n for the remainder, 0 beyond the channels
  AlignedArray<float> inverse;    ///< [padded] 1 / count, 0 beyond the channels
  AlignedArray<float> log_count;  ///< [padded] its logarithm, 0 beyond the channels
  AlignedArray<float> floor;      ///< [padded] smallest Q inside the logarithm, 1 beyond the channels

  /// The term that softmax_row adds to the last logit.
  float last_log_count() const { return log_count[static_cast<size_t>(channels - 1)]; }
  /// Classes that may be an arg-max: all but the remainder.
  int classes() const { return channels - (remainder > 0 ? 1 : 0); }
  /// Classes of the whole label set.
  int all_classes() const { return classes() + remainder; }
};
ClassCounts make_class_counts(int channels, int remainder);

/// Constant over one step.
struct SemanticStep {
  const TrainingView* view = nullptr;
  const SemanticView* cache = nullptr;
  const LossSettings* losses = nullptr;
  const ClassCounts* counts = nullptr;
  int channels = 0;
  size_t padded = 0;    ///< channels rounded up, tile_products.h
  bool couple = false;  ///< the coupling direction is wanted

  /// The weight of one pixel in a mean over the valid ones; this step may sample a part of them.
  float pixel_weight() const { return losses->semantic_sample.scale() / static_cast<float>(cache->valid); }
};

/// The part of the teacher's map under a block, when it is known there throughout: then bilinear sampling is separable.
struct TeacherWindow {
  bool separable = false;
  int first_column = 0, columns = 0;
  int row0[kBlockSize], row1[kBlockSize], column0[kBlockSize], column1[kBlockSize];  ///< of the map, per pixel
  float row_share[kBlockSize], column_share[kBlockSize];                             ///< weight of row1, column1
};

/// Scratch of one thread.
struct SemanticBlock {
  AlignedArray<float> blended;     ///< [64][padded] in: W^T S; out: row gradient g, zero at pixels without a loss
  AlignedArray<float> direction;   ///< [64][padded] coupling direction h
  AlignedArray<float> transposed;  ///< [padded][64] the same
  AlignedArray<float> teacher;     ///< [padded] of one pixel
  AlignedArray<float> window;      ///< [teacher's rows][its columns under the block][padded]
  AlignedArray<float> columns;     ///< [teacher's columns under the block][padded] its rows blended for one pixel row
  AlignedArray<float> student;     ///< [padded] of one pixel
  AlignedArray<float> zeros;       ///< [padded]
  TeacherWindow teacher_window;
  alignas(64) float offset[kBlockPixels];  ///< h_0
  double soft = 0, hard = 0;  ///< sums over this block's pixels, not yet divided by the number of valid ones
};

/// True when some pixel of the block has a semantic loss in this step.
bool block_has_teacher(const SemanticStep& step, const BlockWeights& block);

/// Replaces `blended` by the row gradient; with step.couple also fills direction and offset. Sets soft and hard.
void semantic_block_loss(const SemanticStep& step, const BlockWeights& block, SemanticBlock& scratch);

/// The teacher's float32 probabilities at image pixel (x, y), zero-padded; false where the pixel is not valid, and
/// `teacher` is then unspecified.
bool sample_teacher_padded(const SemanticStep& step, int x, int y, float* teacher);

}  // namespace aligngs::cpu
