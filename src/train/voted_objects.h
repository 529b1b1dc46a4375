// The objects of a trained room: by votes of its photos' segments, or by connections alone.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "gaussians/gaussian_ply.h"
#include "gaussians/instances.h"
#include "scene/scene.h"
#include "train/config.h"

namespace aligngs {

/// Whether the settings ask for votes and every training photo has segments.
bool votes_for_objects(const Scene& scene, const TrainConfig& config);

/// Numbers the objects of labels that are there: by votes (gaussians/object_votes.h) where votes_for_objects(), else as
/// find_instances(). The scene has the cameras of the training. Error{kBadInput} naming a file of segments. The same for
/// any number of threads.
std::vector<Instance> number_objects(const GaussianModel& model, const Scene& scene, const TrainConfig& config,
                                     GaussianLabels& labels, ThreadPool& pool);

}  // namespace aligngs
