// What a finished training leaves in its run folder: scene.ply, scene.labels.ply, classes.json and the
// cameras (camera_outputs.h).
#pragma once

#include "gaussians/gaussian_ply.h"
#include "scene/scene.h"
#include "train/config.h"
#include "train/run_folder.h"

namespace aligngs {

/// scene.ply, and where `assigned` has labels scene.labels.ply and classes.json (counts and objects of each class), into
/// `folder`; each atomically.
void write_scene_files(const std::filesystem::path& folder, const GaussianModel& model, const LabelSet& labels,
                       const GaussianLabels& assigned);

/// Those and the cameras. None of them holds a time or an absolute path.
void write_run_outputs(const RunFolder& folder, const GaussianModel& model, const GaussianLabels& assigned,
                       const Scene& scene, const TrainConfig& config);

}  // namespace aligngs
