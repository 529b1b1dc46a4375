// Connected regions of Gaussians of one class, and what each is called where the photos disagree about it.
#pragma once

#include <cstdint>
#include <vector>

#include "gaussians/gaussian_model.h"
#include "gaussians/point_tree.h"
#include "gaussians/soft_labels.h"

namespace aligngs {

/// Number of the region of each Gaussian, 0 .. count - 1 in order of their first rows. Gaussians of one class that are
/// neighbours within `reach` (scene units) are one region. Faint ones (opacity below 0.05) connect nothing.
struct LabelRegions {
  std::vector<uint32_t> of_gaussian;  ///< [N]
  std::vector<uint16_t> label;        ///< [count] class of each region, kNoLabel: of none
  size_t count = 0;
};
LabelRegions connected_regions(const std::vector<uint16_t>& label, const GaussianModel& model,
                               const NeighbourGraph& graph, double reach);

/// Votes of the photos for each region.
struct RegionEvidence {
  size_t classes = 0;            ///< C
  std::vector<uint16_t> label;   ///< [R] what the region is called so far; kNoLabel: nothing, and so it stays
  std::vector<double> area;      ///< [R] votes for the region, pixels of all photos
  std::vector<double> share;     ///< [R][C] of these votes, by class; a region's shares sum to at most 1
  std::vector<uint16_t> photos;  ///< [R][C] photos in which most of what is seen of the region is called so
};

struct NamingOptions {
  /// that call a region so before it may be called so against the majority: one photo's mistake is not enough
  uint16_t least_photos = 2;
  double least_share = 0.3;  ///< of the votes for the name so far, which a name must have besides
};

/// The name of each region: the current one, or one that enough photos give it. Names of all regions together maximise
/// the expected mean IoU (Nowozin, CVPR 2014, with the ratio of expectations). It is the sum over classes of TP / (P +
/// T - TP), by shares: P the predicted area, T the true area, TP the correct part of P. A class that no majority takes
/// keeps its most likely region, if the other class loses less IoU by that. Regions are visited from the largest to the
/// smallest until no name changes, at most five times. The current one of equal names is kept.
std::vector<uint16_t> name_regions(const RegionEvidence& evidence, const NamingOptions& options = {});

/// Possible names of each Gaussian: up to kTop classes as in SoftLabels.
struct OutlineEvidence {
  size_t classes = 0;            ///< C
  std::vector<double> area;      ///< [N] votes for the Gaussian, pixels of all photos
  SoftLabels soft;               ///< shares of its votes
  std::vector<uint8_t> allowed;  ///< [N][SoftLabels::kTop]
};

/// A label for each Gaussian, its commonest class at first, so that the expected mean IoU of name_regions() grows. A
/// Gaussian of share p goes to the class of the largest (p (1 + J) - J) / U. J is a class's IoU so far, and U the area
/// of its union. A small object with uncertain votes gets the outline of most of its photos' votes, while a wall loses
/// next to nothing. Returns the best of `rounds` such steps. kNoLabel stays.
std::vector<uint16_t> label_outlines(const OutlineEvidence& evidence, int rounds = 8);

}  // namespace aligngs
