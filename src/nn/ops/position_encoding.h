// Fixed position encodings.
#pragma once

#include "nn/tensor.h"

namespace aligngs::nn {

/// VGGT's dense heads: places of a map span a rectangle of the image's aspect (width / height)
/// whose diagonal is 2. For x (first half of the channels) then y: sin(p w_k), cos(p w_k) with w_k
/// = 100^(-k / (channels / 4)).
FeatureMap uv_embedding(int64_t height, int64_t width, int64_t channels, double aspect);
/// Its two halves: rows of x [width, channels / 2] and of y [height, channels / 2].
struct UvAxes {
  Matrix x, y;
};
UvAxes uv_axes(int64_t height, int64_t width, int64_t channels, double aspect);
/// (x, y) of each place of the above.
FeatureMap uv_grid(int64_t height, int64_t width, double aspect);

/// DETR's: y then x in (0, 2 pi], each `features` channels, sine and cosine interleaved,
/// temperature 10000.
FeatureMap sine_encoding(int64_t height, int64_t width, int64_t features);

/// Reference points of deformable attention: ((x + 0.5) / width, (y + 0.5) / height) per place.
Matrix reference_points(int64_t height, int64_t width);

}  // namespace aligngs::nn
