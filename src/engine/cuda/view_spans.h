// One view on the device between projection and the reduction of gradients: which arrays there are and how they are
// indexed. The twins of engine/cpu/splats.h, binning.h, blend_record.h and maps.h.
#pragma once

#include <cstddef>
#include <cstdint>

#include "device/device_span.h"
#include "engine/formulas/projection_camera.h"
#include "engine/formulas/splat.h"

namespace aligngs::cuda {

/// A tile of 16 x 16 pixels is four blocks of 8 x 8, a block two strips of 8 x 4. Pixel number i of a tile lies in
/// block i / 64 (x first) at column i % 8, row i % 64 / 8. A strip is 32 consecutive pixels, which is one warp.
inline constexpr int kBlockSize = 8;  ///< pixels, edge of a block
inline constexpr int kBlockPixels = kBlockSize * kBlockSize;
inline constexpr int kTilePixels = kTileSize * kTileSize;
inline constexpr int kTileBlocks = kTilePixels / kBlockPixels;
inline constexpr int kStripPixels = 32;
inline constexpr int kTileStrips = kTilePixels / kStripPixels;  ///< strip s holds pixels [32 s, 32 s + 32) of the tile
static_assert(kTileStrips == 8, "BlendRecordSpans::strips has a bit for each");

/// Column and row of pixel i within its tile.
ALIGNGS_HD inline int tile_pixel_x(int i) { return (i / kBlockPixels % 2) * kBlockSize + i % kBlockSize; }
ALIGNGS_HD inline int tile_pixel_y(int i) {
  return (i / kBlockPixels / 2) * kBlockSize + i % kBlockPixels / kBlockSize;
}

/// The projected Gaussians. Entries whose rectangle is empty are culled; their other fields are stale.
struct ViewSpans {
  ProjectionCamera<float> camera;
  int width = 0, height = 0;     ///< pixels
  int tiles_x = 0, tiles_y = 0;  ///< tile (x, y) is number y tiles_x + x
  DeviceSpan<Splat> splats;      ///< [N]
  DeviceSpan<TileRect> rects;    ///< [N]
  DeviceSpan<float> radius;      ///< [N] 3 standard deviations along the longer axis, pixels
};

/// The Gaussians that each tile blends. An instance is a (Gaussian, tile) pair with two numbers. "slot" counts by
/// Gaussian, in the row-major order of its rectangle; "place" counts by tile, in depth order.
struct TileListSpans {
  DeviceSpan<uint32_t> slot_begin;  ///< [N + 1] first slot of each Gaussian; equal where it is culled
  DeviceSpan<uint32_t> tile_begin;  ///< [tiles + 1] first place of each tile in `gaussians`
  DeviceSpan<uint32_t> gaussians;   ///< [instances] rows of the model, by tile, by depth, ties by row
  DeviceSpan<uint32_t> rank;        ///< [N] number of unculled rows below this one: a dense index in row order
};

/// A pixel's state in front of every 32nd place of its tile's list, for a backward pass that begins anywhere in it.
struct alignas(16) BlendCheckpoint {
  float transmittance, color[3];  ///< sums of w times colour, without background
};
struct alignas(16) PlaneCheckpoint {
  float normal[3], distance;
};
/// Places from one checkpoint to the next: the lanes of a warp, of which each takes one Gaussian.
inline constexpr uint32_t kCheckpointPlaces = 32;
/// Checkpoints of so many (Gaussian, tile) pairs, [kTilePixels] each. In front of its first place no tile needs one.
inline size_t checkpoint_count(size_t pairs) { return pairs / kCheckpointPlaces; }
/// The one in front of `place` > 0, a multiple of kCheckpointPlaces, of the list that begins at `begin`. A list of n
/// places has (n - 1) / 32 of them, rounded down, so the first of the next list, (begin + n) / 32, is behind its last.
ALIGNGS_HD inline size_t checkpoint_index(uint32_t begin, uint32_t place) {
  return size_t(begin / kCheckpointPlaces) + place / kCheckpointPlaces - 1;
}

/// A record of the forward pass, so that the backward passes compute only Gaussians that counted. A pixel takes every
/// Gaussian whose alpha reaches alpha_min until one would close it.
struct BlendRecordSpans {
  DeviceSpan<uint8_t> strips;       ///< [instances, by place] bit s: some pixel of strip s of the tile took it
  DeviceSpan<uint8_t> seen;         ///< [instances, by slot] 1: some pixel of the tile took it, else 0
  DeviceSpan<uint32_t> last;        ///< [tiles][256] place in the tile's list, plus one, of the last taken; 0: none
  DeviceSpan<float> transmittance;  ///< [tiles][256] what is left behind the last one
  /// [checkpoint_count][256] where the pixel was open; empty: not wanted
  DeviceSpan<BlendCheckpoint> checkpoints{};
  DeviceSpan<PlaneCheckpoint> plane_checkpoints{};  ///< the same, with geometry
};

/// Results of blending per pixel, planar as in engine/maps.h, which describes each map.
struct RenderMapSpans {
  int width = 0, height = 0;
  DeviceSpan<float> color, normal;                      ///< [3][H W]
  DeviceSpan<float> alpha, distance, expected, median;  ///< [H W]; without geometry all but alpha may be empty
};

/// dL/dmaps, planar as in engine/maps.h.
struct MapGradientSpans {
  DeviceSpan<float> color, normal;    ///< [3][H W]
  DeviceSpan<float> distance, alpha;  ///< [H W]
};

}  // namespace aligngs::cuda
