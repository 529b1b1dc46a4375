// The photos that a texture is made from.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "scene/camera.h"
#include "scene/scene.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

struct TexturePhoto {
  Camera camera;         ///< at the photo's size, world of the room
  Image<uint8_t> color;  ///< H x W x 3, sRGB, as all photos exposed alike
  Image<uint8_t> mask;   ///< H x W x 1, 0: do not use this pixel; empty: all are used
  ImageF depth;          ///< H x W x 1, units of the room, of the surface as photographed; 0: none
  float sharpness = 1;   ///< (0, 1], beside the sharpest photo of the room
};

struct TexturePhotos {
  std::vector<TexturePhoto> photos;
  TriangleMesh surface;  ///< as photographed: before edits
};

/// The training photos of a scene, at most `largest` pixels wide or high. Exposures are those of exposure.json; without
/// it they are estimated where photos show the same surface. `surface`: the mesh of the run before edits, which is not
/// empty.
TexturePhotos load_texture_photos(const Scene& scene, const TriangleMesh& surface, ThreadPool& pool,
                                  int largest = 2048);

/// The same in another world.
TexturePhotos moved(TexturePhotos photos, const Similarity& to);

}  // namespace aligngs
