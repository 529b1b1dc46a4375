// The mesh of a room, whose vertices and triangles keep their names.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/apply_edit.h"

namespace aligngs {

/// Gives the mesh of a trained room its names: the numbers of its rows.
void number_mesh(EditableRoom& room);
/// The part of a mesh that submesh() gives (mesh_selection.h), with its names.
void keep_mesh(EditableRoom& room, const std::vector<uint8_t>& flags, uint8_t value);
/// Adds a mesh of new rows. An attribute that the room's mesh has must be there.
void append_mesh(EditableRoom& room, const TriangleMesh& more);

}  // namespace aligngs
