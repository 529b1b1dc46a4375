#include "synth/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/angles.h"
#include "core/error.h"
#include "scene/label_set.h"
#include "synth/noise.h"

namespace aligngs {
namespace {

std::vector<double> even_lines(double low, double high, double cell = kCellSize) {
  const int n = std::max(1, static_cast<int>(std::ceil((high - low) / cell - 1e-9)));
  std::vector<double> lines(static_cast<size_t>(n) + 1);
  for (int i = 0; i <= n; ++i) lines[i] = low + (high - low) * i / n;
  return lines;
}

/// Lines of a side of a rounded box: close together in the rounded ends, even between them.
std::vector<double> rounded_lines(double half, double radius) {
  std::vector<double> lines;
  constexpr int kArc = 3;  // segments per quarter turn of an edge
  for (int i = 0; i < kArc; ++i) lines.push_back(-half + radius * (1 - std::cos(kPi / 2 * i / kArc)));
  const std::vector<double> middle = even_lines(-half + radius, half - radius);
  lines.insert(lines.end(), middle.begin(), middle.end());
  for (int i = kArc - 1; i >= 0; --i) lines.push_back(half - radius * (1 - std::cos(kPi / 2 * i / kArc)));
  return lines;
}

}  // namespace

Rigidd placement(const Vec3d& origin, double degrees) {
  const double a = degrees * kPi / 180, c = std::cos(a), s = std::sin(a);
  return {Mat3d{{c, -s, 0, s, c, 0, 0, 0, 1}}, origin};
}

Rigidd tilt(const Vec3d& origin, double about_x_degrees, double about_y_degrees) {
  const double a = about_x_degrees * kPi / 180, b = about_y_degrees * kPi / 180;
  const Mat3d rx{{1, 0, 0, 0, std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a)}};
  const Mat3d ry{{std::cos(b), 0, std::sin(b), 0, 1, 0, -std::sin(b), 0, std::cos(b)}};
  return {ry * rx, origin};
}

MeshBuilder::MeshBuilder(RoomModel& room, uint64_t seed) : room_(room), random_(seed) {}

uint16_t MeshBuilder::add_material(const Material& material) {
  room_.materials.push_back(material);
  return static_cast<uint16_t>(room_.materials.size() - 1);
}

void MeshBuilder::begin(const std::string& class_name) {
  const int label = ade20k_labels().find(class_name);
  if (label < 0) throw Error({ErrorKind::kFailed, "no class is named '" + class_name + "'", {}, {}, {}});
  room_.objects.push_back({static_cast<uint16_t>(label), class_name});
  object_ = static_cast<uint16_t>(room_.objects.size() - 1);
}

void MeshBuilder::nested(const Rigidd& inner, const std::function<void()>& body) {
  const Rigidd outer = frame_;
  frame_ = outer * inner;
  body();
  frame_ = outer;
}

Vec2f MeshBuilder::texture_offset() {
  return {static_cast<float>(random_.uniform(0, 7)), static_cast<float>(random_.uniform(0, 7))};
}

void MeshBuilder::grid(const std::vector<double>& us, const std::vector<double>& vs, const Surface& surface,
                       const TextureMap& uv) {
  const uint32_t first = static_cast<uint32_t>(room_.positions.size());
  const uint32_t nu = static_cast<uint32_t>(us.size());
  for (const double v : vs) {
    for (const double u : us) {
      room_.positions.push_back((frame_ * surface(u, v)).cast<float>());
      room_.normals.push_back({});
      room_.uvs.push_back(uv(u, v));
    }
  }
  for (uint32_t j = 0; j + 1 < vs.size(); ++j) {
    for (uint32_t i = 0; i + 1 < nu; ++i) {
      const uint32_t a = first + j * nu + i, b = a + 1, c = a + nu, d = c + 1;
      for (const std::array<uint32_t, 3>& t : {std::array<uint32_t, 3>{a, b, d}, std::array<uint32_t, 3>{a, d, c}}) {
        const Vec3f &p = room_.positions[t[0]], &q = room_.positions[t[1]], &r = room_.positions[t[2]];
        if (norm(cross(q - p, r - p)) < 1e-10f) continue;  // poles of turned shapes
        room_.triangles.push_back(t);
        room_.triangle_object.push_back(object_);
        room_.triangle_material.push_back(material_);
      }
    }
  }
}

void MeshBuilder::compute_normals(size_t first_vertex, size_t first_triangle, bool weld) {
  struct Key {
    int32_t x, y, z;
    bool operator==(const Key& o) const { return x == o.x && y == o.y && z == o.z; }
  };
  struct Hash {
    size_t operator()(const Key& k) const { return lattice_hash(k.x, k.y, k.z, 1); }
  };
  std::unordered_map<Key, size_t, Hash> places;
  std::vector<size_t> representative(room_.positions.size() - first_vertex);
  for (size_t i = 0; i < representative.size(); ++i) {
    representative[i] = i;
    if (!weld) continue;
    const Vec3f& p = room_.positions[first_vertex + i];
    const Key key{static_cast<int32_t>(std::lround(p.x * 2e4f)), static_cast<int32_t>(std::lround(p.y * 2e4f)),
                  static_cast<int32_t>(std::lround(p.z * 2e4f))};  // 0.05 mm
    representative[i] = places.emplace(key, i).first->second;
  }
  std::vector<Vec3f> sums(representative.size());
  for (size_t t = first_triangle; t < room_.triangles.size(); ++t) {
    const auto& tri = room_.triangles[t];
    const Vec3f &a = room_.positions[tri[0]], &b = room_.positions[tri[1]], &c = room_.positions[tri[2]];
    const Vec3f n = cross(b - a, c - a);
    for (const uint32_t v : tri) sums[representative[v - first_vertex]] += n;
  }
  for (size_t i = 0; i < representative.size(); ++i) {
    room_.normals[first_vertex + i] = normalized(sums[representative[i]]);
  }
}

void MeshBuilder::rectangle(const Vec3d& corner, const Vec3d& edge_u, const Vec3d& edge_v, bool unit_uv,
                            Vec2d uv_origin) {
  const double lu = norm(edge_u), lv = norm(edge_v);
  const size_t v0 = room_.positions.size(), t0 = room_.triangles.size();
  grid(
      even_lines(0, lu), even_lines(0, lv),
      [&](double u, double v) { return corner + edge_u * (u / lu) + edge_v * (v / lv); },
      [&](double u, double v) {
        return unit_uv ? Vec2f{static_cast<float>(u / lu), static_cast<float>(v / lv)}
                       : Vec2f{static_cast<float>(uv_origin.x + u), static_cast<float>(uv_origin.y + v)};
      });
  compute_normals(v0, t0, false);
}

void MeshBuilder::box(const Vec3d& low, const Vec3d& high) {
  const Vec3d size = high - low;
  const Vec2f offset = texture_offset();
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, 1}) {
      // Axes a, b of the face, ordered so that a x b points outwards.
      int a = (axis + 1) % 3, b = (axis + 2) % 3;
      if (side == 0) std::swap(a, b);
      const bool turn = size[a] < size[b];
      const size_t v0 = room_.positions.size(), t0 = room_.triangles.size();
      grid(
          even_lines(low[a], high[a]), even_lines(low[b], high[b]),
          [&](double u, double v) {
            Vec3d p;
            p[axis] = side == 0 ? low[axis] : high[axis];
            p[a] = u;
            p[b] = v;
            return p;
          },
          [&](double u, double v) {
            const float s = static_cast<float>(turn ? v - low[b] : u - low[a]) + offset.x;
            const float t = static_cast<float>(turn ? u - low[a] : v - low[b]) + offset.y;
            return Vec2f{s, t};
          });
      compute_normals(v0, t0, false);
    }
  }
}

void MeshBuilder::rounded_box(const RoundedBoxShape& shape) {
  const Vec3d centre = (shape.low + shape.high) * 0.5, half = (shape.high - shape.low) * 0.5;
  const double radius = std::min({shape.radius, half.x * 0.99, half.y * 0.99, half.z * 0.99});
  const Vec3d inner = half - Vec3d{radius, radius, radius};
  const Vec2f offset = texture_offset();
  const uint32_t seed = static_cast<uint32_t>(random_.next());
  const auto surface = [&](Vec3d p) {  // p on the surface of the sharp box, centred
    const Vec3d core{std::clamp(p.x, -inner.x, inner.x), std::clamp(p.y, -inner.y, inner.y),
                     std::clamp(p.z, -inner.z, inner.z)};
    const Vec3d n = normalized(p - core);
    Vec3d q = core + n * radius;
    const double sx = 1 - q.x * q.x / (half.x * half.x), sy = 1 - q.y * q.y / (half.y * half.y);
    q.z += shape.bulge * std::max(0.0, sx) * std::max(0.0, sy) * (q.z >= 0 ? 1 : -1);
    if (shape.wrinkle > 0) {
      const float fold =
          fractal_noise(static_cast<float>(q.x * 4 + q.z * 3), static_cast<float>(q.y * 2.5 + q.z), 3, seed);
      q += n * (shape.wrinkle * fold);
    }
    return centre + q;
  };
  const size_t v0 = room_.positions.size(), t0 = room_.triangles.size();
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, 1}) {
      int a = (axis + 1) % 3, b = (axis + 2) % 3;
      if (side == 0) std::swap(a, b);
      const bool turn = half[a] < half[b];
      grid(
          rounded_lines(half[a], radius), rounded_lines(half[b], radius),
          [&](double u, double v) {
            Vec3d p;
            p[axis] = side == 0 ? -half[axis] : half[axis];
            p[a] = u;
            p[b] = v;
            return surface(p);
          },
          [&](double u, double v) {
            return Vec2f{static_cast<float>(turn ? v : u) + offset.x + static_cast<float>(axis) * 0.37f,
                         static_cast<float>(turn ? u : v) + offset.y};
          });
    }
  }
  compute_normals(v0, t0, true);
}

void MeshBuilder::pillow(const Vec3d& centre, double half_x, double half_y, double half_thickness) {
  const Vec2f offset = texture_offset();
  const uint32_t seed = static_cast<uint32_t>(random_.next());
  for (const int side : {1, -1}) {
    const auto surface = [&](double u, double v) {
      // The outline is drawn in between the corners; thickness falls to a seam (superellipse profile).
      const double x = half_x * u * (1 - 0.07 * (1 - v * v)), y = half_y * v * (1 - 0.07 * (1 - u * u));
      const double profile = std::pow(std::max(0.0, 1 - std::pow(std::fabs(u), 2.6)), 0.55) *
                             std::pow(std::max(0.0, 1 - std::pow(std::fabs(v), 2.6)), 0.55);
      const double fold = fractal_noise(static_cast<float>(x * 7), static_cast<float>(y * 7), 3, seed);
      const double z = half_thickness * profile * (1 + 0.16 * fold) + 0.004;
      return centre + Vec3d{x, y, side * z};
    };
    const size_t v0 = room_.positions.size(), t0 = room_.triangles.size();
    const double cell_u = std::min(0.08, kCellSize / half_x * 0.85), cell_v = std::min(0.08, kCellSize / half_y * 0.85);
    const auto us = even_lines(-1, 1, cell_u), vs = even_lines(-1, 1, cell_v);
    const TextureMap uv = [&](double u, double v) {
      return Vec2f{static_cast<float>(u * half_x) + offset.x, static_cast<float>(v * half_y) + offset.y};
    };
    if (side > 0)
      grid(us, vs, surface, uv);
    else
      grid(
          us, vs, [&](double u, double v) { return surface(-u, v); }, uv);
    compute_normals(v0, t0, false);
  }
}

void MeshBuilder::turned(const Vec3d& base, const std::vector<std::pair<double, double>>& profile, bool smooth,
                         int segments) {
  double widest = 0;
  for (const auto& [r, z] : profile) widest = std::max(widest, r);
  segments = std::max(segments, static_cast<int>(std::ceil(2 * kPi * widest / kCellSize)));
  std::vector<double> angles(static_cast<size_t>(segments) + 1);
  for (int i = 0; i <= segments; ++i) angles[i] = 2 * kPi * i / segments;
  const size_t v_all = room_.positions.size(), t_all = room_.triangles.size();
  const Vec2f offset = texture_offset();
  double along = 0;
  for (size_t i = 0; i + 1 < profile.size(); ++i) {
    const auto [r0, z0] = profile[i];
    const auto [r1, z1] = profile[i + 1];
    const double length = std::hypot(r1 - r0, z1 - z0);
    const size_t v0 = room_.positions.size(), t0 = room_.triangles.size();
    const double start = along, low_r = r0, low_z = z0, dr = r1 - r0, dz = z1 - z0;
    grid(
        angles, even_lines(0, 1, kCellSize / std::max(length, 1e-6)),
        [&](double a, double t) {
          const double r = low_r + dr * t;
          return base + Vec3d{r * std::cos(a), r * std::sin(a), low_z + dz * t};
        },
        [&](double a, double t) {
          return Vec2f{static_cast<float>(a * widest) + offset.x, static_cast<float>(start + t * length) + offset.y};
        });
    if (!smooth) compute_normals(v0, t0, true);
    along += length;
  }
  if (smooth) compute_normals(v_all, t_all, true);
}

void MeshBuilder::cylinder(const Vec3d& base, double radius, double height, int segments) {
  turned(base, {{0, 0}, {radius, 0}, {radius, height}, {0, height}}, false, segments);
}

void MeshBuilder::bar(const Vec3d& from, const Vec3d& to, double radius) {
  const Vec3d axis = normalized(to - from);
  nested({rotation_matrix(quaternion_from_z_to(axis)), from}, [&] { cylinder({}, radius, norm(to - from), 10); });
}

void MeshBuilder::sheet(const Surface& surface, double size_u, double size_v, double thickness) {
  const Vec2f offset = texture_offset();
  const auto us = even_lines(0, 1, kCellSize / size_u), vs = even_lines(0, 1, kCellSize / size_v);
  const auto shifted = [&](double u, double v, double shift) {
    constexpr double h = 1e-3;
    const Vec3d n = normalized(cross(surface(u + h, v) - surface(u - h, v), surface(u, v + h) - surface(u, v - h)));
    return surface(u, v) + n * shift;
  };
  const TextureMap front = [&](double u, double v) {
    return Vec2f{static_cast<float>(u * size_u) + offset.x, static_cast<float>(v * size_v) + offset.y};
  };
  size_t v0 = room_.positions.size(), t0 = room_.triangles.size();
  grid(
      us, vs, [&](double u, double v) { return shifted(u, v, thickness / 2); }, front);
  compute_normals(v0, t0, false);
  v0 = room_.positions.size();
  t0 = room_.triangles.size();
  grid(
      us, vs, [&](double u, double v) { return shifted(1 - u, v, -thickness / 2); }, front);
  compute_normals(v0, t0, false);
}

void MeshBuilder::occupy(const Vec3d& low, const Vec3d& high) {
  FurnitureFootprint f{1e9, 1e9, -1e9, -1e9, 0, 0};
  for (const double x : {low.x, high.x}) {
    for (const double y : {low.y, high.y}) {
      const Vec3d p = frame_ * Vec3d{x, y, low.z};
      f.x0 = std::min(f.x0, p.x);
      f.x1 = std::max(f.x1, p.x);
      f.y0 = std::min(f.y0, p.y);
      f.y1 = std::max(f.y1, p.y);
    }
  }
  f.bottom = (frame_ * low).z;
  f.top = (frame_ * high).z;
  room_.footprints.push_back(f);
}

}  // namespace aligngs
