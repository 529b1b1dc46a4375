// The closed-form start of the semantic rows: every view's teacher, weighted by how much of each pixel a Gaussian
// takes.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/model_spans.h"
#include "engine/cuda/teacher_maps.h"
#include "engine/cuda/view_spans.h"
#include "engine/settings.h"

namespace aligngs::cuda {

struct LiftInputs {
  ViewSpans view;
  TileListSpans lists;
  BlendRecordSpans record;  ///< of the forward pass
  TeacherSpans teacher;
  RasterSettings raster;
};

/// sums[row][channel] += sum over the view's valid pixels of w t. Slots are added in their order. Scratch comes from
/// the arena.
void add_teacher_sums(DeviceArena& arena, const LiftInputs& in, DeviceSpan<float> sums);

/// Rows whose sums are not all zero become formulas/semantic_start.h of them; the others stay as they are.
void start_semantic_rows(const DeviceContext& context, DeviceSpan<const float> sums, int remainder,
                         const ModelSpans& model);

}  // namespace aligngs::cuda
