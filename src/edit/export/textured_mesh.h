// Gives the mesh of a file a texture.
#pragma once

#include "edit/export/export_mesh.h"
#include "edit/export/texture_bake.h"

namespace aligngs {

/// Unfolds all objects onto one picture and makes its colours. Vertices are doubled where charts meet. `photos` are of
/// the room's world; `size`: texels, side of the picture at most. Texels are not finer than the photos.
BakeReport add_texture(ExportMesh& mesh, const EditableRoom& room, const TexturePhotos& photos, int size,
                       ThreadPool& pool, const BakeSettings& settings = {});

}  // namespace aligngs
