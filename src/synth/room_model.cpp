#include "synth/room_model.h"

namespace aligngs {

void RoomModel::move_to_world(const Rigidd& motion) {
  for (Vec3f& p : positions) p = (motion * p.cast<double>()).cast<float>();
  for (Vec3f& n : normals) n = normalized((motion.rotation * n.cast<double>()).cast<float>());
  for (AreaLight& light : lights) {
    light.origin = motion * light.origin;
    light.edge_u = motion.rotation * light.edge_u;
    light.edge_v = motion.rotation * light.edge_v;
    light.normal = motion.rotation * light.normal;
  }
  room_to_world = motion * room_to_world;
}

void RoomModel::remove_unused_vertices() {
  std::vector<uint8_t> used(positions.size(), 0);
  for (const auto& t : triangles) {
    for (const uint32_t v : t) used[v] = 1;
  }
  std::vector<uint32_t> target(positions.size(), 0);
  uint32_t kept = 0;
  for (size_t v = 0; v < positions.size(); ++v) {
    if (!used[v]) continue;
    target[v] = kept;
    positions[kept] = positions[v];
    normals[kept] = normals[v];
    uvs[kept++] = uvs[v];
  }
  positions.resize(kept);
  normals.resize(kept);
  uvs.resize(kept);
  for (auto& t : triangles) {
    for (uint32_t& v : t) v = target[v];
  }
}

double RoomModel::triangle_area(size_t triangle) const {
  const auto& t = triangles[triangle];
  const Vec3d a = positions[t[0]].cast<double>(), b = positions[t[1]].cast<double>(),
              c = positions[t[2]].cast<double>();
  return 0.5 * norm(cross(b - a, c - a));
}

double RoomModel::bare_area_share() const {
  double bare = 0, total = 0;
  for (size_t i = 0; i < triangles.size(); ++i) {
    const double area = triangle_area(i);
    total += area;
    if (materials[triangle_material[i]].is_bare()) bare += area;
  }
  return total > 0 ? bare / total : 0;
}

}  // namespace aligngs
