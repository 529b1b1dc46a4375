// What a finished training leaves in its run folder: scene.ply, scene.labels.ply, classes.json and the
// cameras (camera_outputs.h).
#pragma once

#include "gaussians/gaussian_ply.h"
#include "scene/scene.h"
#include "train/config.h"
#include "train/run_folder.h"

namespace aligngs {

/// Class of each Gaussian: the best of softmax(s), its probability as confidence. Rows that no pixel taught
/// (all equal) have no label. The model must have semantic channels.
GaussianLabels label_gaussians(const GaussianModel& model, const LabelSet& labels);

/// Writes them all (labels and classes only with semantics), each atomically. None holds a time or an absolute path.
void write_run_outputs(const RunFolder& folder, const GaussianModel& model, const Scene& scene, const TrainConfig& config);

}  // namespace aligngs
