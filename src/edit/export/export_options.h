// Parts of a room in a file, and how fine its mesh is.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "edit/export/texture_photos.h"

namespace aligngs {

/// Parts of the room in a GLB or USD.
enum class RoomParts { kAll, kMesh, kSplats };

/// The mesh of GLB, OBJ, USD and collision.glb.
struct MeshOptions {
  size_t triangles = 0;  ///< at most; 0: no limit
  double error = 0;      ///< units of the room, how far simplification may move the surface; 0: no limit
  bool closed = false;   ///< holes are closed, also where no photo has looked
  /// Reads the photos that a texture is made from, once all else is done; none: colours of the vertices.
  std::function<TexturePhotos()> photos{};
  int texture_size = 4096;  ///< pixels, side of the texture at most

  bool simplified() const { return triangles > 0 || error > 0; }
};

struct ExportOptions {
  RoomParts parts = RoomParts::kAll;  ///< of a GLB or USD; other formats hold what they hold
  MeshOptions mesh = {};
  /// Formats of a mesh. If set, positions keep their axes, and this is added in double precision. The root node of a GLB
  /// or USD does so, and turns y up. An OBJ has it in its text.
  std::optional<Vec3d> offset = {};
};

}  // namespace aligngs
