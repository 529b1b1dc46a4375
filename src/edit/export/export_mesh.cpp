#include "edit/export/export_mesh.h"

#include "edit/export/textured_mesh.h"
#include "mesh/close_mesh.h"
#include "mesh/simplify_mesh.h"

namespace aligngs {
namespace {

size_t open_edges_of(const std::vector<ObjectMesh>& objects) {
  TriangleMesh all;
  for (const ObjectMesh& object : objects) {
    const uint32_t base = static_cast<uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), object.mesh.vertices.begin(), object.mesh.vertices.end());
    for (const auto& t : object.mesh.triangles) all.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  return open_edges(all);
}

}  // namespace

ExportMesh export_mesh(const EditableRoom& room, const MeshOptions& options, ThreadPool& pool) {
  ExportMesh out;
  if (options.closed) {
    TriangleMesh closed = room.mesh;
    close_mesh(closed);
    out.objects = object_meshes(closed, room.gaussians, room.labels, pool);
  } else {
    out.objects = object_meshes(room, pool);
  }
  for (const ObjectMesh& object : out.objects) out.triangles_before += object.mesh.triangles.size();
  if (options.simplified()) {
    std::vector<TriangleMesh*> parts;
    for (ObjectMesh& object : out.objects) parts.push_back(&object.mesh);
    out.error = simplify_parts(parts, {options.triangles, options.error}).error;
    std::erase_if(out.objects, [](const ObjectMesh& object) { return object.mesh.empty(); });
  }
  for (const ObjectMesh& object : out.objects) out.triangles += object.mesh.triangles.size();
  if (options.closed) out.open_edges = open_edges_of(out.objects);
  if (options.photos) add_texture(out, room, options.photos(), options.texture_size, pool);
  return out;
}

ExportMesh collision_mesh(const EditableRoom& room, const MeshOptions& options, ThreadPool& pool) {
  MeshOptions coarse;
  coarse.closed = options.closed;
  coarse.error = options.error > 0 ? options.error : kColliderError * room.gaussians.extent;
  ExportMesh out = export_mesh(room, coarse, pool);
  if (options.triangles > 0 && out.triangles > options.triangles) {
    coarse.error = 0;
    coarse.triangles = options.triangles;
    out = export_mesh(room, coarse, pool);
  }
  for (ObjectMesh& object : out.objects) {
    object.mesh.normals.clear();
    object.mesh.colors.clear();
  }
  return out;
}

}  // namespace aligngs
