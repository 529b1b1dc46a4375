// Direct light from area lights and diffuse interreflection, per vertex.
#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "synth/shading.h"

namespace aligngs {
namespace {

constexpr size_t kGrain = 512;     // vertices per chunk
constexpr float kLift = 2e-3f;     // metres by which ray origins leave their surface
constexpr double kContact = 0.03;  // metres: a surface whose probes all end this close is hidden
constexpr size_t kProbe = 7;       // index of the last probe
constexpr float kFilter = 0.06f;   // texture footprint when a surface reflects light, metres

struct LightPoint {
  Vec3f position, normal, power;  // power = radiance * area of the piece
};

std::vector<LightPoint> light_points(const RoomModel& room) {
  std::vector<LightPoint> points;
  for (const AreaLight& light : room.lights) {
    const double area = norm(cross(light.edge_u, light.edge_v)) / (light.columns * light.rows);
    for (int j = 0; j < light.rows; ++j) {
      for (int i = 0; i < light.columns; ++i) {
        const Vec3d p =
            light.origin + light.edge_u * ((i + 0.5) / light.columns) + light.edge_v * ((j + 0.5) / light.rows);
        points.push_back({p.cast<float>(), light.normal.cast<float>(), light.radiance * static_cast<float>(area)});
      }
    }
  }
  return points;
}

/// `scene` null: nothing casts a shadow.
Vec3f direct_light(const RoomRays* scene, const std::vector<LightPoint>& points, const Vec3f& p, const Vec3f& n) {
  Vec3f sum;
  for (const LightPoint& light : points) {
    const Vec3f d = light.position - p;
    const float r2 = std::max(dot(d, d), 0.01f);  // bounded close to a lamp
    const float cos_here = dot(d, n), cos_there = -dot(d, light.normal);
    if (cos_here <= 0 || cos_there <= 0) continue;
    const float weight = cos_here * cos_there / (r2 * r2);
    if (weight * light.power.y < 1e-4f) continue;
    if (scene != nullptr && scene->occluded(p, d, 0.0f, 0.995f)) continue;
    sum += light.power * weight;
  }
  return sum;
}

/// Cosine-distributed directions about +z (Malley's method on a Fibonacci disc).
std::vector<Vec3f> hemisphere(int count) {
  std::vector<Vec3f> out;
  for (int i = 0; i < count; ++i) {
    const float r = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
    const float a = 2.39996323f * static_cast<float>(i);  // golden angle
    out.push_back({r * std::cos(a), r * std::sin(a), std::sqrt(std::max(0.0f, 1 - r * r))});
  }
  return out;
}

/// Averages with mesh neighbours of similar orientation: takes out what is left of the sampling pattern.
void smooth_over_mesh(const RoomModel& room, std::vector<Vec3f>& values) {
  std::vector<Vec3f> sums(values.size());
  std::vector<float> weights(values.size(), 0.0f);
  for (const auto& t : room.triangles) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3];
      if (dot(room.normals[a], room.normals[b]) < 0.9f) continue;
      sums[a] += values[b];
      sums[b] += values[a];
      weights[a] += 1;
      weights[b] += 1;
    }
  }
  for (size_t i = 0; i < values.size(); ++i) {
    if (weights[i] > 0) values[i] = values[i] * 0.4f + sums[i] * (0.6f / weights[i]);
  }
}

}  // namespace

LightCache light_room(const RoomRays& scene, ThreadPool& pool, const LightingOptions& options) {
  const RoomModel& room = scene.room();
  const size_t n = room.positions.size();
  std::vector<uint16_t> material(n, 0);
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    for (const uint32_t v : room.triangles[t]) material[v] = room.triangle_material[t];
  }
  const std::vector<LightPoint> points = light_points(room);
  const std::vector<Vec3f> directions = hemisphere(options.directions);
  const size_t count = directions.size();
  constexpr uint32_t kNone = 0xffffffffu;
  std::vector<Vec3f> direct(n), albedo(n);
  // nearest vertex of the surface each direction meets
  std::vector<uint32_t> seen(options.shadows ? n * count : 0, kNone);
  pool.parallel_for(n, kGrain, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3f& normal = room.normals[i];
      const Vec3f p = room.positions[i] + normal * kLift;
      const Material& m = room.materials[material[i]];
      albedo[i] = m.emission > 0 ? Vec3f{} : texture_color(m, room.uvs[i], kFilter);
      if (!options.shadows) {
        direct[i] = direct_light(nullptr, points, p, normal);
        continue;
      }
      const Mat3f frame = rotation_matrix(quaternion_from_z_to(normal));
      size_t close = 0;
      for (size_t k = 0; k < count; ++k) {
        const Vec3f d = frame * directions[k];
        const RayHit hit = scene.intersect(p.cast<double>(), d.cast<double>(), 1e-3);
        close += hit.hit && hit.distance < kContact ? 1 : 0;
        if (k == kProbe && close > kProbe) break;
        if (!hit.hit) continue;
        const auto& t = room.triangles[hit.triangle];
        const float w = 1 - hit.u - hit.v;
        const uint32_t vertex = w >= hit.u && w >= hit.v ? t[0] : (hit.u >= hit.v ? t[1] : t[2]);
        if (dot(room.normals[vertex], d) < 0) seen[i * count + k] = vertex;
      }
      if (close <= kProbe) direct[i] = direct_light(&scene, points, p, normal);
    }
  });
  smooth_over_mesh(room, direct);
  std::vector<Vec3f> indirect(n), next(n);
  if (!options.shadows) {  // the same light from everywhere in place of interreflection
    Vec3f mean;
    for (const Vec3f& e : direct) mean += e * (0.8f / static_cast<float>(n));
    std::fill(indirect.begin(), indirect.end(), mean);
  }
  for (int bounce = 0; options.shadows && bounce < options.bounces; ++bounce) {
    pool.parallel_for(n, kGrain, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        Vec3f sum;
        for (size_t k = 0; k < count; ++k) {
          const uint32_t v = seen[i * count + k];
          if (v == kNone) continue;
          const Vec3f e = direct[v] + indirect[v];
          sum += Vec3f{albedo[v].x * e.x, albedo[v].y * e.y, albedo[v].z * e.z};
        }
        next[i] = sum * (1.0f / static_cast<float>(count));
      }
    });
    indirect.swap(next);
  }
  for (int i = 0; i < 3; ++i) smooth_over_mesh(room, indirect);

  LightCache cache;
  cache.irradiance.resize(n);
  for (size_t i = 0; i < n; ++i) cache.irradiance[i] = direct[i] + indirect[i];
  // Exposed for the light surfaces: 70 % of the lit area is darker than the reference.
  std::vector<std::pair<float, double>> radiances;  // (radiance, area)
  double total = 0;
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    const uint32_t v = room.triangles[t][0];
    const float radiance = albedo[v].y * cache.irradiance[v].y / static_cast<float>(kPi);
    if (!(radiance > 1e-3f)) continue;  // lamps, hidden backs and undersides
    const double area = room.triangle_area(t);
    radiances.push_back({radiance, area});
    total += area;
  }
  std::sort(radiances.begin(), radiances.end());
  constexpr float kReference = 0.75f;  // 1 - exp(-0.75) = 0.53 linear, sRGB 0.75: a white wall, not burnt out
  double below = 0;
  for (const auto& [radiance, area] : radiances) {
    below += area;
    if (below < 0.7 * total) continue;
    cache.exposure = kReference / radiance;
    break;
  }
  return cache;
}

}  // namespace aligngs
