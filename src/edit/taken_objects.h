// Objects that a selection takes for the most part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "gaussians/gaussian_ply.h"

namespace aligngs {

/// The objects of which at least half of the Gaussians are selected. A selection leaves some of them out where their
/// neighbours belong to another object. Gaussians without a label are of no object.
class TakenObjects {
 public:
  /// `selected` has a flag per Gaussian. The labels outlive this.
  TakenObjects(const GaussianLabels& labels, const std::vector<uint8_t>& selected);

  bool holds(uint16_t label, uint16_t instance) const { return objects_.count({label, instance}) > 0; }
  /// Whether a Gaussian is of such an object, selected or not.
  bool holds_row(size_t row) const { return holds(labels_.label[row], labels_.instance[row]); }

 private:
  const GaussianLabels& labels_;
  std::set<std::pair<uint16_t, uint16_t>> objects_;  ///< class and number
};

}  // namespace aligngs
