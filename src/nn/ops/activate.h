// Activations on their own, for the few places where no product comes before them.
#pragma once

#include "nn/cpu/row_kernels.h"
#include "nn/tensor.h"

namespace aligngs::nn {

class Compute;

/// In place, on all threads or on the device.
void activate(Compute& compute, Matrix& x, Activation activation);
void activate(Compute& compute, FeatureMap& x, Activation activation);

}  // namespace aligngs::nn
