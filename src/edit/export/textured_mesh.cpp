#include "edit/export/textured_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/chart_atlas.h"

namespace aligngs {
namespace {

/// Texels per pixel of the photos, at the median distance of what they show. Photos are sampled between pixels: a finer
/// texture keeps more.
constexpr double kTexelsPerPixel = 1.5;
constexpr double kLeastTexel = 1e-4;  // / extent: a third of a millimetre in a room

double texel_of(const TexturePhotos& photos, double extent) {
  std::vector<double> footprints;
  for (const TexturePhoto& photo : photos.photos) {
    constexpr size_t kEvery = 97;  // pixels between samples
    for (size_t i = 0; i < photo.depth.data.size(); i += kEvery) {
      if (photo.depth.data[i] > 0) footprints.push_back(photo.depth.data[i] / photo.camera.fx);
    }
  }
  if (footprints.empty()) return 10 * kLeastTexel * extent;
  const auto middle = footprints.begin() + static_cast<std::ptrdiff_t>(footprints.size() / 2);
  std::nth_element(footprints.begin(), middle, footprints.end());
  return std::max(kLeastTexel * extent, *middle / kTexelsPerPixel);
}

using VertexPlace = std::array<float, 3>;
VertexPlace key(const Vec3f& v) { return {v.x, v.y, v.z}; }

/// Triangles of which edits have changed neither the place nor the colour of a corner.
std::vector<uint8_t> unchanged(const TriangleMesh& mesh, const EditableRoom& room, const TexturePhotos& photos) {
  std::vector<uint8_t> out(mesh.triangles.size(), 1);
  const TriangleMesh& before = photos.surface;
  if (room.mesh.vertices.size() == before.vertices.size() && room.mesh.colors == before.colors) return out;
  std::map<VertexPlace, std::array<uint8_t, 3>> colors;
  for (size_t v = 0; v < before.vertices.size(); ++v)
    colors[key(before.vertices[v])] = before.colors.empty() ? std::array<uint8_t, 3>{} : before.colors[v];
  for (size_t t = 0; t < out.size(); ++t) {
    for (const uint32_t v : mesh.triangles[t]) {
      const auto found = colors.find(key(mesh.vertices[v]));
      if (found == colors.end() || (!mesh.colors.empty() && found->second != mesh.colors[v])) out[t] = 0;
    }
  }
  return out;
}

/// A vertex per corner and chart.
ObjectMesh unfolded(const ObjectMesh& object, const Atlas& atlas, size_t first) {
  ObjectMesh out{.name = object.name,
                 .class_name = object.class_name,
                 .label = object.label,
                 .instance = object.instance,
                 .mesh = {},
                 .uv = {}};
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> made;
  for (size_t t = 0; t < object.mesh.triangles.size(); ++t) {
    std::array<uint32_t, 3> triangle;
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t v = object.mesh.triangles[t][i];
      const auto [at, fresh] =
          made.try_emplace({atlas.chart_of[first + t], v}, static_cast<uint32_t>(out.mesh.vertices.size()));
      triangle[i] = at->second;
      if (!fresh) continue;
      out.mesh.vertices.push_back(object.mesh.vertices[v]);
      if (!object.mesh.normals.empty()) out.mesh.normals.push_back(object.mesh.normals[v]);
      const auto& corner = atlas.corners[first + t][i];
      out.uv.push_back({corner[0] / static_cast<float>(atlas.width), corner[1] / static_cast<float>(atlas.height)});
    }
    out.mesh.triangles.push_back(triangle);
  }
  return out;
}

}  // namespace

BakeReport add_texture(ExportMesh& mesh, const EditableRoom& room, const TexturePhotos& photos, int size,
                       ThreadPool& pool, const BakeSettings& settings) {
  TriangleMesh all;
  std::vector<uint32_t> part;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (uint32_t i = 0; i < mesh.objects.size(); ++i) {
    const TriangleMesh& object = mesh.objects[i].mesh;
    const uint32_t base = static_cast<uint32_t>(all.vertices.size());
    append(all.vertices, object.vertices);
    append(all.normals, object.normals);
    append(all.colors, object.colors);
    for (const auto& t : object.triangles) all.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    part.resize(all.triangles.size(), i);
  }
  if (all.empty()) return {};
  const double extent = room.gaussians.extent;
  AtlasSettings layout;
  layout.size = size;
  layout.texel = texel_of(photos, extent);
  const Atlas atlas = make_atlas(all, part, layout);
  BakeReport report;
  mesh.texture = bake_texture(all, atlas, unchanged(all, room, photos), photos, room.gaussians.model, extent, pool,
                              settings, &report);
  size_t first = 0;
  for (ObjectMesh& object : mesh.objects) {
    const size_t triangles = object.mesh.triangles.size();
    object = unfolded(object, atlas, first);
    first += triangles;
  }
  return report;
}

}  // namespace aligngs
