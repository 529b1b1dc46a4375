// How fast this machine multiplies matrices the way networks do: what an expected time is made from.
#pragma once

#include "nn/compute.h"

namespace aligngs::nn {

/// Operations per second (2 per multiply-add) of a linear layer of 1024 x 1024 on 2048 rows, on all threads of
/// `compute`. The best of several calls within about a quarter of a second.
double measure_matrix_rate(Compute& compute);

}  // namespace aligngs::nn
