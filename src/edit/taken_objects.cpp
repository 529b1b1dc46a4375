#include "edit/taken_objects.h"

#include <map>

#include "scene/triangle_mesh.h"

namespace aligngs {

TakenObjects::TakenObjects(const GaussianLabels& labels, const std::vector<uint8_t>& selected) : labels_(labels) {
  constexpr size_t kMost = 2;                                                 // selected: at least one of two Gaussians
  std::map<std::pair<uint16_t, uint16_t>, std::pair<size_t, size_t>> counts;  // selected, all
  for (size_t i = 0; i < selected.size(); ++i) {
    if (labels.label[i] == kNoLabel) continue;
    auto& [taken, all] = counts[{labels.label[i], labels.instance[i]}];
    taken += selected[i];
    ++all;
  }
  for (const auto& [object, count] : counts) {
    if (kMost * count.first >= count.second) objects_.insert(object);
  }
}

}  // namespace aligngs
