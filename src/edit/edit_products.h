// Files of an edited room.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "edit/edit_session.h"
#include "train/run_folder.h"

namespace aligngs {

/// Writes scene.ply, scene.labels.ply, classes.json and, when there is a mesh, mesh/mesh.ply into `folder`.
void write_room(const std::filesystem::path& folder, const EditableRoom& room);
/// The same for an object on its own, and object.glb.
void write_object(const std::filesystem::path& folder, const EditableRoom& object, ThreadPool& pool);
void write_before_after(const std::filesystem::path& path, const BeforeAfter& picture);
/// run.json of an edited run: the original's record, with where it came from and the edits.
void write_edited_record(const std::filesystem::path& path, RunRecord record, const std::string& command_line,
                         const std::string& scene, const std::filesystem::path& original,
                         const std::vector<EditOperation>& edits, size_t gaussians);
/// Error{kUsage} unless `folder` is absent or empty, and neither a source nor in one.
void require_new_folder(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& sources);

}  // namespace aligngs
