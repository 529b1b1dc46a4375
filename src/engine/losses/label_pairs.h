// Neighbouring pixels that the teacher gives different classes.
#pragma once

#include "core/image.h"
#include "engine/formulas/label_edges.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Calls use(pair) for the right and down neighbours of the pixels of row y whose labels are known and differ.
template <class Use>
void for_each_label_pair(const Image<uint16_t>& labels, int y, const Use& use) {
  for (int x = 0; x < labels.width; ++x) {
    const uint16_t label = labels.at(x, y);
    if (label == kNoLabel) continue;
    if (x + 1 < labels.width) {
      const uint16_t right = labels.at(x + 1, y);
      if (right != label && right != kNoLabel) use(LabelPair{x, y, 1, 0});
    }
    if (y + 1 < labels.height) {
      const uint16_t down = labels.at(x, y + 1);
      if (down != label && down != kNoLabel) use(LabelPair{x, y, 0, 1});
    }
  }
}

}  // namespace aligngs
