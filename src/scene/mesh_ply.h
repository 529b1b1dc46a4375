// Triangle meshes as PLY (ScanNet style: ushort label per vertex).
#pragma once

#include <filesystem>
#include <string>

#include "scene/point_cloud.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Faces with more than three vertices are fanned. Out-of-range indices and non-finite vertices: Error{kBadInput}.
TriangleMesh read_mesh_ply(const std::filesystem::path& path);
void write_mesh_ply(const std::filesystem::path& path, const TriangleMesh& mesh);
/// The content of such a file.
std::string mesh_ply(const TriangleMesh& mesh);
PointCloud read_cloud_ply(const std::filesystem::path& path);

}  // namespace aligngs
