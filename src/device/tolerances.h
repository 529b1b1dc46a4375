// How far the CUDA engine may be from the float32 CPU engine and the double reference, for its tests and for
// tests/cuda/op_compare. The only place with such numbers.
#pragma once

namespace aligngs::cuda {

/// Relative to the largest entry of a map or of a class of gradients, unless a unit is named.
struct CudaTolerance {
  // Tight: everything that is float32 on both sides. A mean of a few hundred pixels has an ulp of 3e-5 pixels. It moves
  // the alpha of a splat of one pixel's size by 1e-4 of itself. Sums are formed in another order.

  // One operation, from the same inputs on both sides.
  double projection = 2e-5;    ///< a dozen operations per number, of which a device may contract products with sums
  double map = 2e-5;           ///< sums of up to a few hundred terms front to back, each within some ulps (6e-8)
  double slot_sum = 2e-5;      ///< the same sums of a few hundred terms in other orders
  double row_gradient = 2e-5;  ///< slots added up, then projection backwards: as `slot_sum`
  double gradient_rms = 1e-5;  ///< the mean of many such squares: their roundings average
  double density_sum = 1e-4;   ///< absolute, of sums of numbers in [-1, 1] over a row's slots, some dozen
  /// absolute, of parameters of size 1 after Adam: the same operations, contracted or not
  double parameter = 1e-6;
  double pose_sum = 1e-4;      ///< shares of all rows, which partly cancel, each rounded as `row_gradient`
  double tile_product = 1e-5;  ///< absolute, 32 products of numbers in [-1, 1] that are exact in bfloat16

  // Values that follow from several of them.
  double expected_depth = 2e-4;  ///< intersection depths of slanted splats amplify the rounding of the mean
  double depth = 1e-3;           ///< a depth is a ratio of two such sums; also relative to 1 + depth
  double unit_normal = 1e-4;     ///< a sum of normals that partly cancel, divided by its length
  double label_probability = 1e-4;
  double lift = 1e-4;                ///< of the logarithm of a sum over all pixels of a view
  double loss = 2e-5;                ///< absolute, losses are of order 1
  double relative_loss = 2e-5;       ///< of one loss from the same maps, beside itself or 1e-3
  double normal_consistency = 2e-4;  ///< absolute; normals of depth are differences of neighbours
  double psnr = 1e-3;                ///< dB: 2e-4 of the mean square
  double gradient = 2e-4;            ///< of a whole step: the rounding of the means enters every alpha
  double pose = 1e-2;       ///< a sum over all rows of such gradients, coupled ones included, which partly cancel
  double two_views = 2e-3;  ///< of a multi-view loss of a whole step: a pixel or patch at a limit is in or out
  double statistic = 5e-4;  ///< the same under absolute values, which do not cancel
  double photometric_rms = 1e-3;
  double total_loss = 1e-4;  ///< of itself, beside the semantic losses
  double nothing = 1e-6;     ///< absolute, of what is 0 in exact arithmetic

  // Loose: what passes through products of bfloat16 operands, 2^-9 relative per term; errors of many terms partly
  // cancel.
  double semantic_row = 4e-3;   ///< 2^-8: a row rounded to bfloat16, from a softmax of other rounding
  double visit_loss = 3e-4;     ///< nats, from the same maps and rows
  double semantic_loss = 2e-3;  ///< nats, of a whole step
  double semantic_gradient = 5e-3;
  double coupling_moment = 2e-2;  ///< q - (the blend behind): the rounding of both remains where they cancel
  double hidden_moment = 3e-2;    ///< the same behind an opaque surface, of the largest there
  double coupling = 2e-3;         ///< of gradients that the semantic loss reaches, beside `gradient`
  double coupling_rms = 1e-2;
  /// of the loss over a dozen steps: Adam turns the sign of a tiny gradient into a step
  double trajectory = 5e-3;

  /// Share of entries that may lie beyond a limit because a decision differs. Examples are an alpha at alpha_min, a
  /// transmittance at a half or at its minimum, a rectangle at the edge of a tile. A small scene has no such entry. An
  /// H200 has 2.1e-4 in the label map of 640 x 480 pixels.
  double flips = 3e-4;
  /// The same where one such decision changes much. A median depth jumps to another surface, or a depth at its alpha
  /// exists or not. The lifted row of a Gaussian of few pixels loses one. One entry in 500.
  double large_flips = 2e-3;
  /// The same of gradients of the multi-view terms. A patch has 49 samples, and the slope of each jumps at a line of
  /// pixel centres. A pixel that comes home within a rounding has no direction. At 640 x 480 pixels, maps moved by an
  /// ulp change 1.8e-3 of the CPU's own entries. An H200 differs in 2.7e-3 of them.
  double two_view_flips = 5e-3;
  /// of Gaussians that such pixels reach, in a whole step of few pixels; an H200 has 4.6e-2
  double two_view_gradient = 8e-2;
};

/// Tolerances of the networks' operators, relative to the largest entry.
struct CudaNetworkTolerance {
  double single = 2e-5;     ///< float32 sums in another order; TF32 with its 11 bits would be above 1e-4
  double bfloat16 = 2e-2;   ///< bfloat16 operands have 8 significant bits
  double rounded = 2e-4;    ///< of the same rounded operands: tensor cores cut sums off, not always alike
  double same_path = 1e-6;  ///< of one operator through two interfaces
};

}  // namespace aligngs::cuda
