#include "engine/cuda/device_frame.h"

#include "core/error.h"
#include "engine/cuda/parameter_gradients.h"

namespace aligngs::cuda {

DeviceFrame take_frame(DeviceArena& arena, const Camera& camera, const RasterSettings& raster, size_t gaussians,
                       bool geometry) {
  DeviceFrame f;
  ViewSpans& v = f.view;
  v.camera = make_projection_camera<float>(camera, raster);
  v.width = camera.width;
  v.height = camera.height;
  v.tiles_x = (camera.width + kTileSize - 1) / kTileSize;
  v.tiles_y = (camera.height + kTileSize - 1) / kTileSize;
  if (v.tiles_x > 65535 || v.tiles_y > 65535) {  // what TileRect and a grid hold
    throw Error({ErrorKind::kFailed,
                 "the camera's image is larger than a million pixels on a side",
                 {},
                 "camera",
                 "render at a smaller size"});
  }
  const size_t n = gaussians;
  v.splats = arena.take<Splat>(n, "projected Gaussians");
  v.rects = arena.take<TileRect>(n, "rectangles of tiles");
  v.radius = arena.take<float>(n, "radii");
  const size_t pixels = static_cast<size_t>(v.width) * static_cast<size_t>(v.height);
  RenderMapSpans& m = f.maps;
  m.width = v.width;
  m.height = v.height;
  m.color = arena.take<float>(3 * pixels, "colour");
  m.alpha = arena.take<float>(pixels, "alpha");
  if (geometry) {
    m.normal = arena.take<float>(3 * pixels, "normals");
    m.distance = arena.take<float>(pixels, "distances");
    m.expected = arena.take<float>(pixels, "expected depth");
    m.median = arena.take<float>(pixels, "median depth");
  }
  f.counts = arena.take_zeroed<BinCounts>(1, "counts");
  f.bad = arena.take<unsigned long long>(1, "state of the step");
  static_assert(kNoBadGradient == ~0ull, "all bits set");
  arena.context().fill_bytes(f.bad.data, 0xFF, sizeof(unsigned long long));
  return f;
}

void take_lists(DeviceArena& arena, size_t pairs, bool record, DeviceFrame& frame) {
  const size_t n = frame.view.rects.size;
  const size_t tiles = static_cast<size_t>(frame.view.tiles_x) * static_cast<size_t>(frame.view.tiles_y);
  frame.lists.slot_begin = arena.take<uint32_t>(n + 1, "slots");
  frame.lists.tile_begin = arena.take<uint32_t>(tiles + 1, "tiles");
  frame.lists.gaussians = arena.take<uint32_t>(pairs, "(Gaussian, tile) pairs");
  frame.lists.rank = arena.take<uint32_t>(n, "ranks");
  if (!record) return;
  frame.record.strips = arena.take<uint8_t>(pairs, "blend record");
  frame.record.seen = arena.take<uint8_t>(pairs, "blend record");
  frame.record.last = arena.take<uint32_t>(tiles * kTilePixels, "blend record");
  frame.record.transmittance = arena.take<float>(tiles * kTilePixels, "blend record");
}

void take_checkpoints(DeviceArena& arena, bool geometry, DeviceFrame& frame) {
  const size_t count = checkpoint_count(frame.lists.gaussians.size) * kTilePixels;
  frame.record.checkpoints = arena.take<BlendCheckpoint>(count, "checkpoints of blending");
  if (geometry) frame.record.plane_checkpoints = arena.take<PlaneCheckpoint>(count, "checkpoints of blending");
}

}  // namespace aligngs::cuda
