#include "cli/stages/pictured_views.h"

#include <algorithm>

namespace aligngs {

PicturedViews pictured_views(const Scene& scene) {
  if (!scene.test.empty()) return {"test", scene.test};
  PicturedViews pictured{"train", {}};
  const size_t count = std::min(kPicturedTrainingViews, scene.train.size());
  for (size_t i = 0; i < count; ++i) {
    pictured.views.push_back(scene.train[i * (scene.train.size() - 1) / std::max<size_t>(1, count - 1)]);
  }
  return pictured;
}

}  // namespace aligngs
