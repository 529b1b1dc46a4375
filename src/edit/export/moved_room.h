// A room in another world: moved, turned and scaled as a whole.
#pragma once

#include <filesystem>

#include "core/rigid.h"
#include "edit/apply_edit.h"

namespace aligngs {

/// Gaussians, mesh, extent and up in the world that `to` leads to. Objects keep their names.
EditableRoom moved(const EditableRoom& room, const Similarity& to);

/// The room in the world of the files that its scene was imported from; `to_original` as scene.json has it.
/// Error{kBadInput} naming
/// `scene_json` where 32-bit floats would move a vertex by more than a ten-thousandth of the room's size there (map
/// coordinates).
EditableRoom in_original_coordinates(const EditableRoom& room, const Similarity& to_original,
                                     const std::filesystem::path& scene_json);

}  // namespace aligngs
