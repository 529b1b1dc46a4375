// The place of a photograph in the input image of a network.
#pragma once

namespace aligngs::nn {

/// u = x * scale_x + offset_x, v = y * scale_y + offset_y, in pixels of the result.
struct ImagePlacement {
  double scale_x = 1, scale_y = 1, offset_x = 0, offset_y = 0;
};

}  // namespace aligngs::nn
