// From blended maps to those of a Rendering: colours and unit normals per pixel, and the guarded depths.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/view_spans.h"

namespace aligngs::cuda {

/// The maps of Rendering (engine.h), interleaved; without geometry only colour.
struct FinishedMaps {
  DeviceSpan<float> color, normal;                ///< [H][W][3]
  DeviceSpan<float> depth_plane, depth_expected;  ///< [H][W]
};

void finish_maps(const DeviceContext& context, const ViewSpans& view, const RenderMapSpans& maps,
                 const FinishedMaps& out);

}  // namespace aligngs::cuda
