// Triangle meshes as PLY (ScanNet style: ushort label per vertex).
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scene/point_cloud.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Faces with more than three vertices are fanned. Out-of-range indices and non-finite vertices: Error{kBadInput}.
TriangleMesh read_mesh_ply(const std::filesystem::path& path);
void write_mesh_ply(const std::filesystem::path& path, const TriangleMesh& mesh);
/// The content of such a file.
std::string mesh_ply(const TriangleMesh& mesh);

/// The vertices of a PLY file as points. Grey where the file has no colours.
struct CloudFile {
  PointCloud cloud;
  std::vector<Vec3d> positions;  ///< those of `cloud`, as precise as the file has them
  size_t left_out = 0;           ///< vertices whose position is not finite, or beyond what float holds
};
CloudFile read_cloud_file(const std::filesystem::path& path);

}  // namespace aligngs
