// The arrays of one view on its way through a step or a rendering, taken from the arena.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/binning.h"
#include "engine/cuda/view_spans.h"
#include "engine/settings.h"
#include "scene/camera.h"

namespace aligngs::cuda {

struct DeviceFrame {
  ViewSpans view;
  TileListSpans lists;
  RenderMapSpans maps;
  BlendRecordSpans record;             ///< empty without record
  DeviceSpan<BinCounts> counts;        ///< [1]
  DeviceSpan<unsigned long long> bad;  ///< [1] kNoBadGradient
};

/// Allocates `view`, `maps` (colour and alpha, with geometry all), `counts` and `bad` of a view. All but `bad` are
/// undefined until project_view, count_tile_pairs and blend_forward fill them. Throws Error{kFailed} for an image of
/// more than a million pixels on a side.
DeviceFrame take_frame(DeviceArena& arena, const Camera& camera, const RasterSettings& raster, size_t gaussians,
                       bool geometry);

/// Takes `lists` with room for so many (Gaussian, tile) pairs and, with `record`, what the backward passes need. To be
/// filled by build_tile_lists and blend_forward.
void take_lists(DeviceArena& arena, size_t pairs, bool record, DeviceFrame& frame);

/// Takes the checkpoints of the record of `frame`, after its lists.
void take_checkpoints(DeviceArena& arena, bool geometry, DeviceFrame& frame);

}  // namespace aligngs::cuda
