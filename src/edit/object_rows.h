// The Gaussians of each object.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "gaussians/gaussian_ply.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Class and number of an object; number 0: what is of no object of its class.
using ObjectName = std::pair<uint16_t, uint16_t>;

/// Rows of the Gaussians of each, ascending; those without a label are of none.
inline std::map<ObjectName, std::vector<uint32_t>> rows_of_objects(const GaussianLabels& labels) {
  std::map<ObjectName, std::vector<uint32_t>> rows;
  for (uint32_t i = 0; i < labels.label.size(); ++i) {
    if (labels.label[i] != kNoLabel) rows[{labels.label[i], labels.instance[i]}].push_back(i);
  }
  return rows;
}

}  // namespace aligngs
