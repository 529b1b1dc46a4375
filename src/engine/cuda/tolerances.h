// How far the CUDA engine may be from the float32 CPU engine and the double reference, for its tests.
#pragma once

namespace aligngs::cuda {

/// Relative to the largest entry of a map or of a class of gradients, unless a unit is named.
struct CudaTolerance {
  // Tight: everything that is float32 on both sides. A mean of a few hundred pixels has an ulp of 3e-5 pixels, which
  // moves the alpha of a splat of one pixel's size by 1e-4 of itself; sums are formed in another order.
  double map = 2e-5;
  double expected_depth = 2e-4;
  double loss = 2e-5;
  double gradient = 2e-4;
  double statistic = 5e-4;
  // Loose: what passes through products of bfloat16 operands, 2^-9 relative per term.
  double semantic_loss = 2e-3;      ///< nats
  double semantic_gradient = 5e-3;
  double coupling = 2e-3;           ///< of gradients that the semantic loss reaches, beside `gradient`
};

}  // namespace aligngs::cuda
