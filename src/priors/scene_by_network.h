// Photos without cameras: VGGT or Depth Anything 3 finds cameras, depth and its confidence in one pass over all of them.
#pragma once

#include <filesystem>
#include <vector>

#include "core/thread_pool.h"
#include "priors/model_store.h"
#include "priors/photo_folder.h"
#include "priors/scene_from_photos.h"

namespace aligngs {

/// Writes the scene of `photos` with the network of options.model, and adds to the report. With Depth Anything 3 a second
/// network tells metres where it is installed. Error{kWeights} without the weights, Error{kResources} where memory is
/// too small, Error{kFailed} where no point is left of the depth. Error{kBadInput} where options.test_every leaves too
/// few photos for training.
void scene_by_network(const std::vector<Photo>& photos, const std::filesystem::path& scene, const ModelStore& store,
                      const ScenePhotosOptions& options, ThreadPool& pool, ScenePhotosReport& report);

}  // namespace aligngs
