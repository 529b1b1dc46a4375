// The cameras of a run in the three forms that other programs read.
#pragma once

#include "scene/scene.h"
#include "train/config.h"
#include "train/run_folder.h"

namespace aligngs {

/// Writes, each file atomically, for the views of the split:
/// - cameras.json: what viewers of Gaussians read, at the resolution of training (camera to world, OpenCV axes);
/// - sparse/0: a COLMAP model with the scene's points, at the size of the images;
/// - transforms.json: nerfstudio's layout (camera to world, OpenGL axes), with paths relative to the run folder.
void write_camera_outputs(const RunFolder& folder, const Scene& scene, const TrainConfig& config);

}  // namespace aligngs
