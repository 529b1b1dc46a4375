// Networks that find cameras as teachers: the method that runs them, and what they make of photos.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "nn/weights.h"
#include "priors/predicted_view.h"
#include "priors/scene_from_photos.h"

namespace aligngs {

struct Teacher;

/// Checks memory, loads the network of `weights` and lets it see all photos. Error{kResources} where memory is too
/// small, Error{kWeights} without the network for metres that is asked for, Error{kFailed} for an impossible camera.
using FindViews = PredictedViews (*)(const std::vector<Photo>& photos, const nn::Weights& weights,
                                     const Teacher& teacher, const ModelStore& store, const ScenePhotosOptions& options,
                                     ThreadPool& pool);

/// Networks of one design, as the rows of priors/teacher_list.h name them.
struct CameraFamily {
  PosesMethod method;  ///< of "--method"
  FindViews find_views;
};

extern const CameraFamily kVggtCameras;  ///< VGGT and networks of its structure
extern const CameraFamily kDa3Cameras;   ///< Depth Anything 3, with metres where its metric network is there

}  // namespace aligngs
