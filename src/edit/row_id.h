// Names of the rows of a room. They stay while edits come and go.
#pragma once

#include <cstdint>
#include <vector>

namespace aligngs {

/// The upper 32 bits are the number of the edit that made the row, 0 for the trained room. The lower 32 are its place
/// there. The rows of a room are in ascending order of these names.
using RowId = uint64_t;

inline constexpr RowId kNewRow = ~RowId(0);  ///< made by an edit that has no number yet
inline RowId row_of_edit(uint32_t edit, uint32_t row) { return RowId(edit) << 32 | row; }

/// The rows of a mesh.
struct MeshRows {
  std::vector<RowId> vertices, triangles;
};

}  // namespace aligngs
