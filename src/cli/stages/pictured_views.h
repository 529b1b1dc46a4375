// Views that the pictures of a run show.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace aligngs {

/// A run of somebody's own photos has no test views: pictures of a few training views then show what it became.
inline constexpr size_t kPicturedTrainingViews = 4;

struct PicturedViews {
  const char* split;       ///< "test" or "train", as folders of renders/ are called
  std::vector<int> views;  ///< indices into Scene::views
};

/// All test views. A scene without any: kPicturedTrainingViews training views, spread over their order.
PicturedViews pictured_views(const Scene& scene);

}  // namespace aligngs
