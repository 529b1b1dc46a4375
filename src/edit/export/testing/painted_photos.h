// Photos of a mesh that is painted with a pattern of its places.
#pragma once

#include <cmath>

#include "edit/export/texture_photos.h"
#include "metrics/visibility.h"

namespace aligngs::painted {

/// Smooth in space, so that a texel's place need not be known well.
inline Vec3f pattern(const Vec3f& p) {
  return {0.5f + 0.3f * std::sin(3 * p.x), 0.5f + 0.3f * std::cos(4 * p.z), 0.3f + 0.2f * std::sin(2 * p.x + 3 * p.z)};
}

/// Four photos from above the side z < 0 of the small room, whose up is -y; they look at its middle.
inline TexturePhotos photos(const TriangleMesh& mesh, ThreadPool& pool) {
  TexturePhotos out;
  out.surface = mesh;
  const RayScene rays(mesh);
  for (const double x : {-0.9, -0.3, 0.3, 0.9}) {
    TexturePhoto photo;
    Camera& camera = photo.camera;
    camera = {320, 240, 260, 260, 160, 120, {}};
    const Vec3d eye{x, -1.3, -1.4}, forward = normalized(Vec3d{0, 0, 0.1} - eye),
                                    right = normalized(cross(Vec3d{0, 1, 0}, forward)), down = cross(forward, right);
    for (int i = 0; i < 3; ++i) {
      camera.world_to_camera.rotation(0, i) = right[i];
      camera.world_to_camera.rotation(1, i) = down[i];
      camera.world_to_camera.rotation(2, i) = forward[i];
    }
    camera.world_to_camera.translation = -(camera.world_to_camera.rotation * eye);
    photo.depth = rays.cast(camera, pool).depth;
    photo.color = Image<uint8_t>(camera.width, camera.height, 3, 0);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        if (!(photo.depth.at(u, v) > 0)) continue;
        const Vec3f color = pattern(camera.unproject(u + 0.5, v + 0.5, photo.depth.at(u, v)).cast<float>());
        for (int c = 0; c < 3; ++c) photo.color.at(u, v, c) = static_cast<uint8_t>(std::lround(255 * color[c]));
      }
    }
    out.photos.push_back(std::move(photo));
  }
  return out;
}

}  // namespace aligngs::painted
