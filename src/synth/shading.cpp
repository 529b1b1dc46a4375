#include "synth/shading.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/srgb.h"
#include "scene/triangle_mesh.h"
#include "synth/noise.h"
#include "synth/outside.h"
#include "synth/texture_math.h"

namespace aligngs {
namespace {

struct SurfacePoint {
  const Material* material = nullptr;
  Vec3f normal;  // shading normal, not turned
  Vec2f uv;
  Vec3f irradiance;
};

SurfacePoint surface_at(const RoomModel& room, const LightCache& lights, const RayHit& hit) {
  const auto& t = room.triangles[hit.triangle];
  const float w = 1 - hit.u - hit.v;
  SurfacePoint s;
  s.material = &room.materials[room.triangle_material[hit.triangle]];
  s.normal = normalized(room.normals[t[0]] * w + room.normals[t[1]] * hit.u + room.normals[t[2]] * hit.v);
  s.uv = {room.uvs[t[0]].x * w + room.uvs[t[1]].x * hit.u + room.uvs[t[2]].x * hit.v,
          room.uvs[t[0]].y * w + room.uvs[t[1]].y * hit.u + room.uvs[t[2]].y * hit.v};
  s.irradiance = lights.irradiance[t[0]] * w + lights.irradiance[t[1]] * hit.u + lights.irradiance[t[2]] * hit.v;
  return s;
}

Vec3f diffuse_radiance(const SurfacePoint& s, float footprint) {
  const Material& m = *s.material;
  const Vec3f color = texture_color(m, s.uv, footprint);
  if (m.emission > 0) return color * m.emission;
  return Vec3f{color.x * s.irradiance.x, color.y * s.irradiance.y, color.z * s.irradiance.z} * (1 / kPiFloat);
}

/// Exposure and a film-like shoulder; the result is linear in [0, 1].
Vec3f tone_map(const Vec3f& radiance, float exposure) {
  return {1 - std::exp(-radiance.x * exposure), 1 - std::exp(-radiance.y * exposure),
          1 - std::exp(-radiance.z * exposure)};
}

/// Light that comes from a hit without its reflections: its own, or the view outside.
Vec3f direct_radiance(const RoomModel& room, const SurfacePoint& s, const Vec3d& at, const Vec3d& direction,
                      float footprint) {
  if (!s.material->see_through) return diffuse_radiance(s, footprint);
  const Rigidd to_room = room.room_to_world.inverse();
  const Vec3d middle{room.width / 2, room.depth / 2, 0};
  return outside_color(to_room * at - middle, to_room.rotation * direction, {}, s.material->seed) *
         s.material->emission;
}

/// Share of the light that a surface mirrors: Schlick's approximation of Fresnel's law (1994).
float mirrored_share(const Material& m, float cosine) {
  return m.gloss * (m.reflectance + (1 - m.reflectance) * std::pow(1 - cosine, 5.0f));
}

/// Mean radiance along mirrored rays; no value where all of them enter the surface.
std::optional<Vec3f> mirrored_radiance(const RoomRays& scene, const LightCache& lights, const Material& material,
                                       const Vec3d& start, const Vec3f& view, const Vec3f& n, float footprint,
                                       float pixel_angle, uint32_t jitter_seed) {
  const float rough = material.roughness;
  Vec3f sum;
  int rays = 0;
  for (int i = 0; i < material.mirror_rays; ++i) {
    Vec3f mirror = view - n * (2 * dot(view, n));
    mirror += Vec3f{lattice_random(0, i, 0, jitter_seed) - 0.5f, lattice_random(1, i, 0, jitter_seed) - 0.5f,
                    lattice_random(2, i, 0, jitter_seed) - 0.5f} *
              (2 * rough);
    mirror = normalized(mirror);
    if (dot(mirror, n) <= 0.01f) continue;
    ++rays;
    const RayHit second = scene.intersect(start, mirror.cast<double>(), 1e-3);
    if (!second.hit) continue;
    const Vec3f seen = direct_radiance(scene.room(), surface_at(scene.room(), lights, second),
                                       start + mirror.cast<double>() * second.distance, mirror.cast<double>(),
                                       footprint + static_cast<float>(second.distance) * (pixel_angle + rough));
    // A highlight need not be brighter than film can hold: keeps its border free of sparkles.
    const float peak = 4 / lights.exposure;
    sum += Vec3f{std::min(seen.x, peak), std::min(seen.y, peak), std::min(seen.z, peak)};
  }
  if (rays == 0) return std::nullopt;
  return sum * (1.0f / static_cast<float>(rays));
}

/// Radiance along a primary ray. `pixel_angle` is the width of a sample in radians.
Vec3f trace(const RoomRays& scene, const LightCache& lights, const Vec3d& origin, const Vec3d& direction,
            float pixel_angle, uint32_t jitter_seed) {
  const RayHit hit = scene.intersect(origin, direction);
  if (!hit.hit) return {};
  const SurfacePoint s = surface_at(scene.room(), lights, hit);
  const Vec3f view = normalized(direction.cast<float>());
  const float cosine = std::fabs(dot(s.normal, view));
  const float distance = static_cast<float>(hit.distance * norm(direction));
  const float footprint = distance * pixel_angle / std::sqrt(std::max(cosine, 0.05f));
  const Vec3d at = origin + direction * hit.distance;
  const Vec3f radiance = direct_radiance(scene.room(), s, at, direction, footprint);
  if (s.material->gloss <= 0) return radiance;
  const float share = mirrored_share(*s.material, cosine);
  const Vec3f n = dot(s.normal, view) > 0 ? -s.normal : s.normal;
  const std::optional<Vec3f> reflected = mirrored_radiance(scene, lights, *s.material, at + n.cast<double>() * 1e-3,
                                                           view, n, footprint, pixel_angle, jitter_seed);
  return reflected ? radiance * (1 - share) + *reflected * share : radiance;
}

/// Maps of a pixel whose ray meets `material` after `hit`, with the normal `n` towards the camera.
void gloss_maps(const RoomRays& scene, const Material& material, const Vec3d& origin, const Vec3d& direction,
                const RayHit& hit, const Vec3d& n, int x, int y, RenderedView& view) {
  const double length = norm(direction);
  const float share = mirrored_share(material, static_cast<float>(std::fabs(dot(n, direction)) / length));
  view.mirrored.at(x, y) = share;
  view.sensed.at(x, y) = material.see_through ? 0.0f : static_cast<float>(hit.distance);
  constexpr float kSilvered = 0.5f;  // a surface that mirrors more than it scatters
  if (material.gloss * material.reflectance < kSilvered) return;
  const Vec3d mirror = direction - n * (2 * dot(direction, n));
  const RayHit second = scene.intersect(origin + direction * hit.distance + n * 1e-3, mirror, 1e-3);
  view.sensed.at(x, y) = second.hit ? static_cast<float>(hit.distance + second.distance) : 0.0f;
}

void exact_maps(const RoomRays& scene, const Rigidd& camera_to_world, int x, int y, RenderedView& view) {
  const RoomModel& room = scene.room();
  const Vec3d direction = camera_to_world.rotation * view.camera.ray(x + 0.5, y + 0.5);
  const RayHit hit = scene.intersect(camera_to_world.translation, direction);
  if (!hit.hit) return;
  view.depth.at(x, y) = static_cast<float>(hit.distance);  // the ray has z = 1 in the camera's frame
  const auto& t = room.triangles[hit.triangle];
  const Vec3d a = room.positions[t[0]].cast<double>(), b = room.positions[t[1]].cast<double>(),
              c = room.positions[t[2]].cast<double>();
  Vec3d n = normalized(cross(b - a, c - a));
  if (dot(n, direction) > 0) n = -n;
  for (int k = 0; k < 3; ++k) view.normal.at(x, y, k) = static_cast<float>(n[k]);
  const uint16_t object = room.triangle_object[hit.triangle];
  view.labels.at(x, y) = room.objects[object].label;
  view.instances.at(x, y) = object;
  const Material& material = room.materials[room.triangle_material[hit.triangle]];
  view.unreliable.at(x, y) = material.unreliable_depth ? 1 : 0;
  if (room.strong_gloss) gloss_maps(scene, material, camera_to_world.translation, direction, hit, n, x, y, view);
}

}  // namespace

RenderedView render_view(const RoomRays& scene, const LightCache* lights, const Camera& camera,
                         const RayTraceOptions& options, ThreadPool& pool) {
  const int w = camera.width, h = camera.height;
  RenderedView view;
  view.camera = camera;
  if (options.color && lights != nullptr) view.color = ImageF(w, h, 3);
  view.depth = ImageF(w, h, 1);
  view.normal = ImageF(w, h, 3);
  view.labels = Image<uint16_t>(w, h, 1, kNoLabel);
  view.instances = Image<uint16_t>(w, h, 1, 65535);
  view.unreliable = Image<uint8_t>(w, h, 1, 0);
  if (scene.room().strong_gloss) view.mirrored = view.sensed = ImageF(w, h, 1);
  const Rigidd camera_to_world = camera.world_to_camera.inverse();
  const int n = std::max(1, options.samples_per_side);
  const float pixel_angle = static_cast<float>(1 / camera.fx) / static_cast<float>(n);
  pool.parallel_for(static_cast<size_t>(h), 4, [&](size_t begin, size_t end, int) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < w; ++x) {
        exact_maps(scene, camera_to_world, x, y, view);
        if (view.color.empty()) continue;
        Vec3f sum;
        for (int j = 0; j < n; ++j) {
          for (int i = 0; i < n; ++i) {
            const Vec3d ray = camera.ray(x + (i + 0.5) / n, y + (j + 0.5) / n);
            const uint32_t jitter = lattice_hash(x * n + i, y * n + j, 0, 77u);
            sum += tone_map(
                trace(scene, *lights, camera_to_world.translation, camera_to_world.rotation * ray, pixel_angle, jitter),
                lights->exposure);
          }
        }
        sum *= 1.0f / static_cast<float>(n * n);
        for (int k = 0; k < 3; ++k) view.color.at(x, y, k) = srgb_encode(sum[k]);
      }
    }
  });
  return view;
}

std::vector<Vec3f> vertex_colors(const RoomModel& room, const LightCache& lights) {
  std::vector<Vec3f> colors(room.positions.size());
  std::vector<bool> done(room.positions.size(), false);
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    const Material& m = room.materials[room.triangle_material[t]];
    for (const uint32_t v : room.triangles[t]) {
      if (done[v]) continue;
      done[v] = true;
      SurfacePoint s{&m, room.normals[v], room.uvs[v], lights.irradiance[v]};
      const Vec3f c = tone_map(diffuse_radiance(s, 0.02f), lights.exposure);
      colors[v] = {srgb_encode(c.x), srgb_encode(c.y), srgb_encode(c.z)};
    }
  }
  return colors;
}

}  // namespace aligngs
