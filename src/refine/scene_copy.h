// Common part of the scene folders written by this module: a copy of another scene, something of it replaced.
#pragma once

#include <filesystem>
#include <vector>

#include "core/vec.h"
#include "scene/scene.h"

namespace aligngs {

/// All files of a scene folder. Error{kResources} when the disk is full.
void copy_scene(const std::filesystem::path& from, const std::filesystem::path& to);

/// split.json of the views that are used, where some of the scene's were left out: their names would mean nothing
/// there.
void write_used_split(const Scene& scene, const std::filesystem::path& folder);

/// A copy of a whole scene as a folder of this program's own, complete or not at all. Errors of require_scene_place().
void write_scene_copy(const std::filesystem::path& from, const std::filesystem::path& to, bool overwrite);

/// sparse/ with other cameras, of all views, and the scene's points.
void write_scene_cameras(const Scene& scene, const std::vector<Camera>& cameras, const std::filesystem::path& folder);

/// exposure.json of the training views, in the order of Scene::train.
void write_training_exposure(const Scene& scene, const std::vector<Vec3f>& log_gains,
                             const std::filesystem::path& folder);

}  // namespace aligngs
