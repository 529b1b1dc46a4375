// A room in another world: moved, turned and scaled as a whole.
#pragma once

#include <filesystem>

#include "core/rigid.h"
#include "edit/apply_edit.h"

namespace aligngs {

/// Gaussians, mesh, extent and up in the world that `to` leads to. Objects keep their names.
EditableRoom moved(EditableRoom room, const Similarity& to);

/// The room without origins and names of rows, which edits need and files do not have.
EditableRoom without_row_names(const EditableRoom& room);

/// A room whose coordinates lack an offset.
struct OffsetRoom {
  EditableRoom room;
  Vec3d offset;  ///< to be added to all positions
};

/// The room in the world of the files that its scene was imported from; `to_original` as scene.json has it. 32-bit floats
/// may move a vertex by more than a ten-thousandth of the room's size there (map coordinates). Then the offset is kept
/// apart, or Error{kBadInput} names `scene_json` where the format has no place for it.
OffsetRoom in_original_coordinates(EditableRoom room, const Similarity& to_original,
                                   const std::filesystem::path& scene_json, bool holds_offset);

}  // namespace aligngs
