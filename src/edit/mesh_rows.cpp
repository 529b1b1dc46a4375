#include "edit/mesh_rows.h"

#include <numeric>

#include "core/append.h"
#include "core/chosen_rows.h"
#include "edit/mesh_selection.h"

namespace aligngs {

void number_mesh(EditableRoom& room) {
  room.mesh_rows.vertices.resize(room.mesh.vertices.size());
  room.mesh_rows.triangles.resize(room.mesh.triangles.size());
  std::iota(room.mesh_rows.vertices.begin(), room.mesh_rows.vertices.end(), RowId(0));
  std::iota(room.mesh_rows.triangles.begin(), room.mesh_rows.triangles.end(), RowId(0));
}

void keep_mesh(EditableRoom& room, const std::vector<uint8_t>& flags, uint8_t value) {
  if (room.mesh.vertices.empty()) return;
  SubmeshRows rows;
  room.mesh = submesh(room.mesh, flags, value, &rows);
  room.mesh_rows.vertices = chosen_rows(room.mesh_rows.vertices, rows.vertices);
  room.mesh_rows.triangles = chosen_rows(room.mesh_rows.triangles, rows.triangles);
}

void append_mesh(EditableRoom& room, const TriangleMesh& more) {
  TriangleMesh& mesh = room.mesh;
  const uint32_t base = static_cast<uint32_t>(mesh.vertices.size());
  append_exactly(mesh.vertices, more.vertices);
  if (!mesh.normals.empty()) append_exactly(mesh.normals, more.normals);
  if (!mesh.colors.empty()) append_exactly(mesh.colors, more.colors);
  if (!mesh.labels.empty()) append_exactly(mesh.labels, more.labels);
  mesh.triangles.reserve(mesh.triangles.size() + more.triangles.size());
  for (const auto& t : more.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  room.mesh_rows.vertices.reserve(mesh.vertices.size());
  room.mesh_rows.triangles.reserve(mesh.triangles.size());
  room.mesh_rows.vertices.resize(mesh.vertices.size(), kNewRow);
  room.mesh_rows.triangles.resize(mesh.triangles.size(), kNewRow);
}

}  // namespace aligngs
