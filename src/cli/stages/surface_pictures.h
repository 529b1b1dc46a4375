// Pictures of a mesh without its colours: what the surface itself looks like.
#pragma once

#include <filesystem>
#include <vector>

#include "cli/stages/loaded_run.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Unit normals of the faces that the rays through the pixel centres meet first, H x W x 3, camera frame, turned to the
/// camera. Zero where nothing is met.
ImageF face_normals(const TriangleMesh& mesh, const Camera& camera, ThreadPool& pool);

/// Writes folder/VIEW.png for each of `views`: the mesh from there, coloured by its face normals as rendered normals are.
void write_surface_pictures(const LoadedRun& run, const TriangleMesh& mesh, const std::vector<int>& views,
                            const std::filesystem::path& folder);

}  // namespace aligngs
