#include "scene/mesh_ply.h"

#include <cmath>
#include <cstring>
#include <string>

#include "core/error.h"
#include "core/far_outliers.h"
#include "io/atomic_file.h"
#include "io/ply.h"
#include "io/ply_colors.h"

namespace aligngs {
namespace {

/// Three scalar columns of an element, e.g. x y z; all null when one is absent.
struct Columns3 {
  const PlyProperty* column[3] = {nullptr, nullptr, nullptr};
  Columns3(const PlyElement& element, const char* a, const char* b, const char* c) {
    const char* names[3] = {a, b, c};
    for (int i = 0; i < 3; ++i) {
      column[i] = element.find(names[i]);
      if (!column[i] || column[i]->is_list) {
        column[0] = nullptr;
        return;
      }
    }
  }
  explicit operator bool() const { return column[0] != nullptr; }
  Vec3d row(size_t i) const { return {column[0]->values[i], column[1]->values[i], column[2]->values[i]}; }
};

const PlyElement& vertex_element(const PlyFile& file, const std::filesystem::path& path) {
  const PlyElement* vertices = file.find("vertex");
  if (!vertices) throw_bad_input(path, "header", "no element 'vertex'", "export the surface as PLY with vertices");
  return *vertices;
}

Columns3 positions_of(const PlyElement& vertices, const std::filesystem::path& path) {
  const Columns3 xyz(vertices, "x", "y", "z");
  if (!xyz) throw_bad_input(path, "vertex", "no properties x, y, z", "export the surface with vertex positions");
  return xyz;
}

std::vector<Vec3f> read_positions(const PlyElement& vertices, const std::filesystem::path& path) {
  const Columns3 xyz = positions_of(vertices, path);
  std::vector<Vec3f> out(vertices.count);
  for (size_t i = 0; i < out.size(); ++i) {
    const Vec3f p = xyz.row(i).cast<float>();
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      throw_bad_input(path, "vertex " + std::to_string(i), "position is not finite", "remove this vertex");
    }
    // Coordinates of maps have 10 million metres at most; triangles of vertices beyond hide all others.
    constexpr float kFarthest = 1e9f;
    if (std::fmax(std::fabs(p.x), std::fmax(std::fabs(p.y), std::fabs(p.z))) > kFarthest)
      throw_bad_input(path, "vertex " + std::to_string(i), "it lies more than 1e9 from the origin",
                      "remove this vertex");
    out[i] = p;
  }
  return out;
}

std::vector<Vec3f> read_normals(const PlyElement& vertices) {
  const Columns3 normal(vertices, "nx", "ny", "nz");
  std::vector<Vec3f> out;
  if (!normal) return out;
  out.resize(vertices.count);
  bool any = false;
  for (size_t i = 0; i < out.size(); ++i) {
    const Vec3d n = normalized(normal.row(i));
    if (!std::isfinite(dot(n, n)) || dot(n, n) == 0) continue;
    out[i] = n.cast<float>();
    any = true;
  }
  if (!any) out.clear();  // many programs write zeros: no normals
  return out;
}

void append_faces(const PlyElement& faces, size_t vertex_count, const std::filesystem::path& path,
                  std::vector<std::array<uint32_t, 3>>& triangles) {
  const PlyProperty* indices = faces.find("vertex_indices");
  if (!indices) indices = faces.find("vertex_index");
  if (!indices || !indices->is_list) {
    throw_bad_input(path, "face", "no list property vertex_indices", "export the surface with faces");
  }
  for (size_t f = 0; f < faces.count; ++f) {
    const uint64_t begin = indices->offsets[f], end = indices->offsets[f + 1];
    for (uint64_t k = begin; k < end; ++k) {
      const double index = indices->values[k];
      if (!(index >= 0 && index < static_cast<double>(vertex_count))) {
        throw_bad_input(path, "face " + std::to_string(f),
                        "vertex index outside of 0.." + std::to_string(vertex_count) + " (exclusive)",
                        "the file is damaged: write it again");
      }
    }
    const auto index_at = [&](uint64_t k) { return static_cast<uint32_t>(indices->values[k]); };
    for (uint64_t k = begin + 2; k < end; ++k) triangles.push_back({index_at(begin), index_at(k - 1), index_at(k)});
  }
}

template <class T>
void put(std::string& out, const T& value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

void put(std::string& out, const Vec3f& v) {
  put(out, v.x);
  put(out, v.y);
  put(out, v.z);
}

template <class Column>
void require_rows(const Column& column, size_t rows, const std::filesystem::path& path, const char* name) {
  if (column.empty() || column.size() == rows) return;
  throw Error({ErrorKind::kFailed, "one value per vertex or none expected", path, name, {}});
}

}  // namespace

TriangleMesh read_mesh_ply(const std::filesystem::path& path) {
  const PlyFile file = read_ply(path);
  const PlyElement& vertices = vertex_element(file, path);
  TriangleMesh mesh;
  mesh.vertices = read_positions(vertices, path);
  mesh.normals = read_normals(vertices);
  const std::vector<Vec3f> colors = ply_colors(vertices);
  for (const Vec3f& c : colors) {
    mesh.colors.push_back({static_cast<uint8_t>(std::lround(c.x * 255)), static_cast<uint8_t>(std::lround(c.y * 255)),
                           static_cast<uint8_t>(std::lround(c.z * 255))});
  }
  if (const PlyProperty* label = vertices.find("label"); label && !label->is_list) {
    mesh.labels.resize(vertices.count, kNoLabel);
    for (size_t i = 0; i < mesh.labels.size(); ++i) {
      const double value = label->values[i];
      if (value >= 0 && value < kNoLabel) mesh.labels[i] = static_cast<uint16_t>(value);
    }
  }
  if (const PlyElement* faces = file.find("face")) append_faces(*faces, mesh.vertices.size(), path, mesh.triangles);
  if (const PlyElement* strips = file.find("tristrips"); strips && strips->count > 0 && mesh.triangles.empty())
    throw_bad_input(path, "tristrips", "strips of triangles are not read", "write the surface with faces");
  return mesh;
}

namespace {

/// Hands over the file in pieces of about a megabyte.
template <class Sink>
void encode(const std::filesystem::path& path, const TriangleMesh& mesh, const Sink& sink) {
  const size_t count = mesh.vertices.size();
  require_rows(mesh.normals, count, path, "normals");
  require_rows(mesh.colors, count, path, "colors");
  require_rows(mesh.labels, count, path, "labels");
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(count) +
                    "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!mesh.normals.empty()) out += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.colors.empty()) out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!mesh.labels.empty()) out += "property ushort label\n";
  out += "element face " + std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";

  constexpr size_t kFlush = size_t(1) << 20;  // bytes handed over at a time
  const auto flush_at = [&](size_t limit) {
    if (out.size() < limit) return;
    sink(out);
    out.clear();
  };
  for (size_t i = 0; i < count; ++i) {
    put(out, mesh.vertices[i]);
    if (!mesh.normals.empty()) put(out, mesh.normals[i]);
    if (!mesh.colors.empty()) put(out, mesh.colors[i]);
    if (!mesh.labels.empty()) put(out, mesh.labels[i]);
    flush_at(kFlush);
  }
  for (const auto& triangle : mesh.triangles) {
    put(out, uint8_t(3));
    for (uint32_t index : triangle) put(out, index);
    flush_at(kFlush);
  }
  flush_at(0);
}

}  // namespace

void write_mesh_ply(const std::filesystem::path& path, const TriangleMesh& mesh) {
  AtomicFile file(path);
  encode(path, mesh, [&](const std::string& bytes) { file.write(bytes); });
  file.commit();
}

std::string mesh_ply(const TriangleMesh& mesh) {
  std::string out;
  encode({}, mesh, [&](const std::string& bytes) { out += bytes; });
  return out;
}

CloudFile read_cloud_file(const std::filesystem::path& path) {
  const PlyFile file = read_ply(path);
  const PlyElement& vertices = vertex_element(file, path);
  const Columns3 xyz = positions_of(vertices, path);
  const std::vector<Vec3f> normals = read_normals(vertices), colors = ply_colors(vertices);
  CloudFile out;
  std::vector<size_t> rows;
  std::vector<Vec3d> places;
  for (size_t i = 0; i < vertices.count; ++i) {
    const Vec3d position = xyz.row(i);
    if (!std::isfinite(norm(position.cast<float>()))) continue;
    rows.push_back(i);
    places.push_back(position);
  }
  const std::vector<bool> far = far_outliers(places);
  for (size_t k = 0; k < rows.size(); ++k) {
    if (far[k]) continue;
    const size_t i = rows[k];
    out.positions.push_back(places[k]);
    out.cloud.positions.push_back(places[k].cast<float>());
    out.cloud.colors.push_back(colors.empty() ? Vec3f{0.5f, 0.5f, 0.5f} : colors[i]);  // mid grey: colour unknown
    if (!normals.empty()) out.cloud.normals.push_back(normals[i]);
  }
  out.left_out = vertices.count - out.positions.size();
  return out;
}

}  // namespace aligngs
