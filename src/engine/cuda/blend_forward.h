// Colour, alpha, normal, distance and depths of every pixel.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/view_spans.h"
#include "engine/settings.h"

namespace aligngs::cuda {

struct BlendForwardInputs {
  ViewSpans view;
  TileListSpans lists;
  RasterSettings raster;
  bool geometry = false;  ///< normal, distance and depths are wanted
};

/// Writes `maps`, without geometry only colour and alpha, and `record` unless its spans are empty (its checkpoints may
/// be alone in being so). Each tile is a block of 256 threads, each strip of 8 x 4 pixels a warp that blends the
/// Gaussians that can reach it.
void blend_forward(const DeviceContext& context, const BlendForwardInputs& in, const RenderMapSpans& maps,
                   const BlendRecordSpans& record);

}  // namespace aligngs::cuda
