// People and other things that move are left out of photos by their class labels.
#pragma once

#include <string>
#include <vector>

#include "core/image.h"
#include "scene/label_set.h"
#include "scene/view_data.h"

namespace aligngs {

/// Class numbers of a list of names and synonyms, "person, cat, dog": sorted, each once; none for an empty list.
/// Error{kUsage} for a name that is no class. The lone default "person" is none where the label set has no such class.
std::vector<int> ignored_classes(const LabelSet& labels, const std::string& list);

inline constexpr const char* kIgnoredByDefault = "person";

struct IgnoredRegionOptions {
  /// share of the longer side: a teacher's map is coarse, and what moves has a blurred edge
  double border = 0.015;
  double least_share = 0.001;  ///< of the pixels: smaller regions stay, since a teacher errs in single pixels
};

/// 0 where a label is one of the classes and within a border around it, else 255. `labels` are those of a view's teacher
/// (target_labels()); pixels without a label count as seen.
Image<uint8_t> mask_without(const Image<uint16_t>& labels, const std::vector<int>& classes,
                            const IgnoredRegionOptions& options = {});

}  // namespace aligngs
