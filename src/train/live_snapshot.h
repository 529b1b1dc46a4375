// The Gaussians of a training that is going on, for pages that look on.
#pragma once

#include "core/thread_pool.h"
#include "gaussians/gaussian_model.h"
#include "scene/label_set.h"
#include "train/run_folder.h"

namespace aligngs {

/// RUN/live/scene.ply: position, constant colour, opacity, scale and rotation of each Gaussian, and with semantics its
/// most probable class (label, instance 0, confidence); 61 bytes each. Enough to look at, not to go on from. Gaussians
/// with a value that is not finite are left out.
void write_live_snapshot(const RunFolder& folder, const GaussianModel& model, const LabelSet& labels, ThreadPool& pool);
/// When training ends, scene.ply takes its place.
void remove_live_snapshot(const RunFolder& folder);

}  // namespace aligngs
