// The arrays of one view on its way through a step or a rendering, taken from the arena.
#pragma once

#include "engine/cuda/binning.h"
#include "engine/cuda/runtime/device_memory.h"
#include "engine/cuda/view_spans.h"
#include "engine/settings.h"
#include "scene/camera.h"

namespace aligngs::cuda {

struct DeviceFrame {
  ViewSpans view;
  TileListSpans lists;
  RenderMapSpans maps;
  BlendRecordSpans record;         ///< empty without record
  DeviceSpan<BinCounts> counts;    ///< [1]
  DeviceSpan<unsigned long long> bad;  ///< [1] kNoBadGradient
};

struct FrameOptions {
  size_t gaussians = 0;
  size_t pairs = 0;       ///< room for (Gaussian, tile) pairs
  bool geometry = false;  ///< all maps, else colour and alpha
  bool record = false;    ///< what the backward passes need
};

/// Everything but `counts` and `bad` is undefined until project_view, build_tile_lists and blend_forward filled it.
/// Throws Error{kFailed} for an image of more than a million pixels on a side.
DeviceFrame take_frame(DeviceArena& arena, const Camera& camera, const RasterSettings& raster,
                       const FrameOptions& options);

}  // namespace aligngs::cuda
