// The class of every pixel: blended semantic rows, their arg-max and its probability, in float32. For renderings, not
// for training.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/model_spans.h"
#include "engine/cuda/view_spans.h"
#include "engine/settings.h"

namespace aligngs::cuda {

struct LabelInputs {
  ModelSpans model;  ///< with channels
  ViewSpans view;
  TileListSpans lists;
  BlendRecordSpans record;        ///< of the forward pass
  DeviceSpan<const float> alpha;  ///< [H W]
  RasterSettings raster;
  SemanticBlend blend{};
  int remainder = 0;  ///< classes that the last channel represents; 0: it is one class
};

struct LabelOutputs {
  /// [H W] arg-max over the classes with a channel of their own, kNoLabel where alpha < 0.5
  DeviceSpan<uint16_t> channel;
  DeviceSpan<float> probability;  ///< [H W] of the arg-max, also where there is no label
};

/// Scratch comes from the arena.
void label_map(DeviceArena& arena, const LabelInputs& in, const LabelOutputs& out);

}  // namespace aligngs::cuda
