// One label per pixel of a photo, the same along what looks alike: a surface seldom ends where the photo shows no edge.
#pragma once

#include <cstdint>

#include "core/image.h"

namespace aligngs {

struct LabelPathSettings {
  float change = 16;        ///< cost of a neighbour with another label, where the photo shows no edge
  double luma_edge = 0.03;  ///< steps of the photo's luma of this size halve it
  float class_edge = 0.3f;  ///< factor on it between pixels of two classes
};

/// `costs`: H x W x labels. Costs are summed over paths from eight directions (Hirschmueller 2008). A path may change
/// its label anywhere for the same price. `classes`: H x W, what the pixels show; empty where nothing is labelled.
/// Returns H x W: the label of the least sum, the first of equal ones.
Image<uint8_t> label_by_paths(const ImageF& costs, const ImageF& luma, const Image<uint16_t>& classes,
                              const LabelPathSettings& settings);

}  // namespace aligngs
