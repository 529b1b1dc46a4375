// The room as files: what a finished training, or an edit, leaves. None of them holds a time or an absolute path.
#pragma once

#include <filesystem>

#include "gaussians/gaussian_ply.h"
#include "scene/label_set.h"

namespace aligngs {

/// scene.labels.ply and classes.json (counts and objects of each class) into `folder`, each atomically. Nothing without
/// labels in `assigned`.
void write_label_files(const std::filesystem::path& folder, const GaussianModel& model, const LabelSet& labels,
                       const GaussianLabels& assigned);

/// scene.ply, then write_label_files().
void write_scene_files(const std::filesystem::path& folder, const GaussianModel& model, const LabelSet& labels,
                       const GaussianLabels& assigned);

}  // namespace aligngs
