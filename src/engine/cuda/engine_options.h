// Kernels with the same results, of which a device may prefer either. What is not measured on a device yet has the
// default that costs least memory.
#pragma once

#include "engine/cuda/blend_backward.h"
#include "engine/cuda/semantic_visit.h"

namespace aligngs::cuda {

struct CudaEngineOptions {
  BlendBackwardMethod blend_backward = BlendBackwardMethod::kPerPixel;
  SemanticVisitMethod semantic_visit = SemanticVisitMethod::kAutomatic;
};

}  // namespace aligngs::cuda
