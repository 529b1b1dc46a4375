// Semantic rows of the Gaussians: what is blended, and the way back from the blended rows to the logits.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/model_spans.h"
#include "engine/cuda/view_spans.h"
#include "engine/settings.h"

namespace aligngs::cuda {

/// Most channels (after the active classes) that the visit to a tile holds in a block's shared memory.
inline constexpr int kMaxSemanticChannels = 256;
/// Numbers in a row on the device: channels rounded up to the tiles of the matrix products.
inline constexpr int kRowPadding = 16;
ALIGNGS_HD inline int padded_channels(int channels) { return (channels + kRowPadding - 1) / kRowPadding * kRowPadding; }

struct SemanticRowInputs {
  ModelSpans model;
  DeviceSpan<const uint8_t> touched;  ///< [N]
  DeviceSpan<const uint32_t> rank;    ///< [N] TileListSpans::rank
  SemanticBlend blend{};
  int remainder = 0;  ///< classes that the last channel represents (ActiveClasses::remainder); 0: every channel is one
};

/// rows[rank][padded_channels] in bfloat16, zero beyond the channels, of every touched Gaussian. kProbabilities:
/// softmax(s). kLogits: s minus its mean, which a softmax of blended logits does not see but the rounding does.
void semantic_rows(const DeviceContext& context, const SemanticRowInputs& in, DeviceSpan<uint16_t> rows);

struct SemanticGradientInputs {
  SemanticRowInputs rows;
  TileListSpans lists;
  DeviceSpan<const float> row_slots;  ///< [instances][padded] SemanticVisitOutputs::row_slots
  DeviceSpan<const uint8_t> seen;     ///< [instances] the same
};
struct SemanticGradientOutputs {
  DeviceSpan<float> gradients;         ///< [unculled rows][padded] dL/dlogits by rank, where written
  DeviceSpan<uint8_t> written;         ///< [N] 1: some pixel with a teacher took the Gaussian, else 0
  DeviceSpan<unsigned long long> bad;  ///< [1] as in ParameterGradientOutputs
};

/// Adds up the slots of each row in their order and goes back through the softmax.
void semantic_gradients(const DeviceContext& context, const SemanticGradientInputs& in,
                        const SemanticGradientOutputs& out);

}  // namespace aligngs::cuda
