// Choices of the CUDA engine that keep its results: kernels of which a device may prefer either, and how they are
// launched. A choice not yet measured on a device defaults to the one with least memory.
#pragma once

#include "engine/cuda/blend_backward.h"
#include "engine/cuda/semantic_visit.h"

namespace aligngs::cuda {

struct CudaEngineOptions {
  BlendBackwardMethod blend_backward = BlendBackwardMethod::kPerPixel;
  SemanticVisitMethod semantic_visit = SemanticVisitMethod::kAutomatic;
  /// A step becomes one CUDA graph (runtime/step_graph.h) instead of some 40 launches, except for the first visit to a
  /// view. Off until a device has shown what it gains: `aligngs bench --device cuda:N --graphs`.
  bool graphs = false;
  /// StepReport::seconds has a stage for a stage, as the CPU engine's, instead of "step" alone: time on the device.
  bool time_stages = false;
};

}  // namespace aligngs::cuda
