// Light in a room: soft direct light and diffuse interreflection per mesh vertex, and the pictures made with it.
#pragma once

#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "synth/raytracer.h"

namespace aligngs {

/// Irradiance (linear RGB) at every vertex of the room. Computed once per room: every view sees the same light,
/// free of sampling noise.
struct LightCache {
  std::vector<Vec3f> irradiance;
  float exposure = 1;  ///< factor that brings the room's mean radiance to a medium grey
};

struct LightingOptions {
  int directions = 48;  ///< cosine-distributed rays per vertex for interreflection
  int bounces = 3;
  bool shadows = true;  ///< false: no rays at all, every light reaches every surface that faces it (drafts, tests)
};

LightCache light_room(const RoomRays& scene, ThreadPool& pool, const LightingOptions& options = {});

/// One picture with its exact maps. All maps are taken at pixel centres.
struct RenderedView {
  Camera camera;
  ImageF color;               ///< H x W x 3 sRGB [0, 1], antialiased; empty when not asked for
  ImageF depth;               ///< metres along the camera's z axis; 0 where no surface
  ImageF normal;              ///< H x W x 3, unit, world, turned to the camera
  Image<uint16_t> labels;     ///< ADE20K class; kNoLabel where no surface
  Image<uint16_t> instances;  ///< index into RoomModel::objects; 65535 where no surface
  Image<uint8_t> unreliable;  ///< 1 on glass, screens and dark gloss
  /// Share of the light that is mirrored at the pixel's centre, 0 to 1. Empty without strong gloss.
  ImageF mirrored;
  /// The same rooms: where the light of a depth sensor turns back, metres along z. The room in a mirror, as far behind
  /// it as it is mirrored; 0 through a pane; elsewhere `depth`.
  ImageF sensed;
};

struct RayTraceOptions {
  bool color = true;
  int samples_per_side = 2;  ///< antialiasing: a grid of n x n samples per pixel
};

/// Renders a view; `lights` may be null when color is false. The same for any number of threads.
RenderedView render_view(const RoomRays& scene, const LightCache* lights, const Camera& camera,
                         const RayTraceOptions& options, ThreadPool& pool);

/// sRGB colour of every vertex under the room's light (for the truth mesh).
std::vector<Vec3f> vertex_colors(const RoomModel& room, const LightCache& lights);

}  // namespace aligngs
