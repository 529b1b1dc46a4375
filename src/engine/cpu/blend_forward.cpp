#include "engine/cpu/blend_forward.h"

#include <cstring>

#include "engine/cpu/lane_places.h"
#include "engine/cpu/simd_targets.h"
#include "engine/formulas/blending.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/blend_forward.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/alpha-inl.h"
#include "engine/cpu/intersection-inl.h"
#include "engine/cpu/overlap-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

/// Gaussians taken at a time: most tiles end within two.
constexpr size_t kGather = 256;
/// How far ahead the gather asks for a splat: a miss of the last-level cache lasts about this many copies.
constexpr size_t kPrefetch = 12;
constexpr int kStripRows = kStripPixels / kBlockSize;
static_assert(kTileSize == 2 * kBlockSize);
/// A list may be written a whole vector beyond its last entry.
constexpr size_t kListLength = kGather + kLanes;

/// Appends first + lane for every lane of `hit` to a list and returns how many. Writes a whole vector: a store of its
/// first lanes alone takes many times as long on some processors.
HWY_INLINE size_t append_lanes(uint32_t first, hn::Mask<FloatTag> hit, uint32_t* list) {
  const FloatTag d;
  const hn::RebindToUnsigned<FloatTag> du;
#if HWY_TARGET == HWY_AVX2
  // GCC copies the kilobyte of Highway's table to the stack at every call of Compress.
  uint8_t bits[kByteBits];
  hn::StoreMaskBits(d, hit, bits);
  const hn::Rebind<uint8_t, FloatTag> bytes;
  const auto lanes = hn::PromoteTo(du, hn::LoadU(bytes, kPlacesOfBits.data() + kByteBits * bits[0]));
  hn::StoreU(hn::Add(lanes, hn::Set(du, first)), du, list);
#else
  hn::StoreU(hn::Compress(hn::Iota(du, first), hn::RebindMask(du, hit)), du, list);
#endif
  return hn::CountTrue(d, hit);
}

/// Appends the numbers of the Gaussians that each strip of `open` can reach; counts[strip] is the length of its list.
void list_strips(const Splat* splats, size_t count, float tile_x, float tile_y, const bool* open, uint32_t* lists,
                 size_t* counts) {
  const FloatTag d;
  for (size_t first = 0; first < count; first += kLanes) {
    const size_t n = HWY_MIN(kLanes, count - first);
    const OverlapLanes lanes = overlap_lanes(splats + first, n);
    const auto real = hn::FirstN(d, n);
    const BoxColumns columns[2] = {box_columns(lanes, tile_x, kBlockSize),
                                   box_columns(lanes, tile_x + kBlockSize, kBlockSize)};
    for (int row = 0; row < kTileStrips / 2; ++row) {
      const BoxRows rows = box_rows(lanes, tile_y + static_cast<float>(row * kStripRows), kStripRows);
      for (int column = 0; column < 2; ++column) {
        const int strip = (row / kBlockStrips * 2 + column) * kBlockStrips + row % kBlockStrips;
        if (!open[strip]) continue;
        const auto hit = hn::And(real, reaches_box(lanes, columns[column], rows));
        counts[strip] += append_lanes(static_cast<uint32_t>(first), hit, lists + strip * kListLength + counts[strip]);
      }
    }
  }
}

/// The sums of a vector of pixels.
using PlaceTag = hn::RebindToSigned<FloatTag>;
struct PixelSums {
  FloatVec color[3], alpha, normal[3], distance, expected, median;
  hn::Vec<PlaceTag> last;
};
template <BlendedMaps kMaps>
HWY_INLINE PixelSums load_sums(const BlockMaps& maps, size_t at) {
  const FloatTag d;
  const FloatVec zero = hn::Zero(d);
  PixelSums s{{zero, zero, zero}, zero, {zero, zero, zero}, zero, zero, zero, hn::Load(PlaceTag(), maps.last + at)};
  for (int k = 0; k < 3; ++k) s.color[k] = hn::Load(d, maps.color[k] + at);
  s.alpha = hn::Load(d, maps.alpha + at);
  if constexpr (has_geometry(kMaps)) {
    for (int k = 0; k < 3; ++k) s.normal[k] = hn::Load(d, maps.normal[k] + at);
    s.distance = hn::Load(d, maps.distance + at);
    s.expected = hn::Load(d, maps.expected + at);
  }
  if constexpr (has_median(kMaps)) s.median = hn::Load(d, maps.median + at);
  return s;
}
template <BlendedMaps kMaps>
HWY_INLINE void store_sums(const PixelSums& s, BlockMaps& maps, size_t at) {
  const FloatTag d;
  for (int k = 0; k < 3; ++k) hn::Store(s.color[k], d, maps.color[k] + at);
  hn::Store(s.alpha, d, maps.alpha + at);
  hn::Store(s.last, PlaceTag(), maps.last + at);
  if constexpr (has_geometry(kMaps)) {
    for (int k = 0; k < 3; ++k) hn::Store(s.normal[k], d, maps.normal[k] + at);
    hn::Store(s.distance, d, maps.distance + at);
    hn::Store(s.expected, d, maps.expected + at);
  }
  if constexpr (has_median(kMaps)) hn::Store(s.median, d, maps.median + at);
}

/// The Gaussians taken from the tile's list at a time.
struct GatheredSplats {
  const Splat* splats;
  uint16_t* strips;  ///< of TileForward
  int32_t place;     ///< of the first in the tile's list, plus one
};

/// Blends a list of a batch's Gaussians into the pixels of one vector. Its first pixel is number `at` of the block at
/// (x, y). `strip` is the bit of their strip. Returns false when all of them are closed.
template <BlendedMaps kMaps, bool kSmooth>
bool blend_pixels(const GatheredSplats& batch, const uint32_t* list, size_t count, const AlphaConstants& constants,
                  const ProjectionCamera<float>& camera, int x, int y, size_t at, unsigned strip, BlockMaps& maps) {
  const FloatTag d;
  const PlaceTag di;
  const FloatVec zero = hn::Zero(d), half = hn::Set(d, float(kMedianTransmittance));
  const FloatVec pixel_x = pixel_centres_x(x, at), pixel_y = pixel_centres_y(y, at);
  RayLanes ray{zero, zero, zero};
  if constexpr (has_geometry(kMaps)) ray = ray_lanes(camera, pixel_x, pixel_y);
  PixelSums sums = load_sums<kMaps>(maps, at);
  FloatVec t = hn::Load(d, maps.transmittance + at);
  bool open = true;
  bool undecided = !hn::AllFalse(d, hn::Ge(t, half));  // some pixel has no median depth yet
  for (size_t i = 0; i < count && open; ++i) {
    const Splat& g = batch.splats[list[i]];
    const FloatVec before = t;
    const FloatVec fdx = hn::Mul(hn::Set(d, g.fxx), hn::Sub(pixel_x, hn::Set(d, g.x)));
    const AlphaLanes a = alpha_lanes<kSmooth>(g, fdx, pixel_y, constants, t);
    const FloatVec w = hn::Mul(a.alpha, before);
    for (int k = 0; k < 3; ++k) sums.color[k] = hn::MulAdd(w, hn::Set(d, g.color[k]), sums.color[k]);
    sums.alpha = hn::Add(sums.alpha, w);
    const auto place = hn::Set(di, batch.place + static_cast<int32_t>(list[i]));
    sums.last = hn::IfThenElse(hn::RebindMask(di, a.taken), place, sums.last);
    batch.strips[list[i]] |= static_cast<uint16_t>(hn::AllFalse(d, a.taken) ? 0u : strip);
    if constexpr (has_geometry(kMaps)) {
      for (int k = 0; k < 3; ++k) sums.normal[k] = hn::MulAdd(w, hn::Set(d, g.normal[k]), sums.normal[k]);
      sums.distance = hn::MulAdd(w, hn::Set(d, g.distance), sums.distance);
      const FloatVec z = intersection(d, g, ray.x, ray.y, ray.grazing);
      sums.expected = hn::MulAdd(w, z, sums.expected);
      if (has_median(kMaps) && undecided) {
        const auto crossing = hn::And(a.taken, hn::And(hn::Ge(before, half), hn::Lt(t, half)));
        sums.median = hn::IfThenElse(crossing, z, sums.median);
        undecided = !hn::AllFalse(d, hn::Ge(t, half));
      }
    }
    open = !hn::AllFalse(d, hn::Gt(t, zero));
  }
  store_sums<kMaps>(sums, maps, at);
  hn::Store(t, d, maps.transmittance + at);
  return open;
}

/// The same for the median depth alone: a pixel is closed where it has one.
template <bool kSmooth>
bool find_medians(const GatheredSplats& batch, const uint32_t* list, size_t count, const AlphaConstants& constants,
                  const ProjectionCamera<float>& camera, int x, int y, size_t at, BlockMaps& maps) {
  const FloatTag d;
  const FloatVec half = hn::Set(d, float(kMedianTransmittance));
  const FloatVec pixel_x = pixel_centres_x(x, at), pixel_y = pixel_centres_y(y, at);
  const RayLanes ray = ray_lanes(camera, pixel_x, pixel_y);
  FloatVec median = hn::Load(d, maps.median + at), t = hn::Load(d, maps.transmittance + at);
  bool undecided = !hn::AllFalse(d, hn::Ge(t, half));
  for (size_t i = 0; i < count && undecided; ++i) {
    const Splat& g = batch.splats[list[i]];
    const FloatVec before = t;
    const FloatVec fdx = hn::Mul(hn::Set(d, g.fxx), hn::Sub(pixel_x, hn::Set(d, g.x)));
    const AlphaLanes a = alpha_lanes<kSmooth>(g, fdx, pixel_y, constants, t);
    const auto crossing = hn::And(a.taken, hn::And(hn::Ge(before, half), hn::Lt(t, half)));
    if (!hn::AllFalse(d, crossing))
      median = hn::IfThenElse(crossing, intersection(d, g, ray.x, ray.y, ray.grazing), median);
    undecided = !hn::AllFalse(d, hn::Ge(t, half));
  }
  hn::Store(median, d, maps.median + at);
  hn::Store(t, d, maps.transmittance + at);
  return undecided;
}

template <BlendedMaps kMaps, bool kSmooth>
void blend_tile(const ProjectedView& view, const TileLists& lists, int tile_x, int tile_y, const RasterSettings& raster,
                uint8_t* seen, TileForward& out) {
  constexpr int kStrips = kTileStrips;
  const size_t tile = size_t(tile_y) * view.tiles_x + tile_x;
  const uint32_t* list = lists.gaussians.data() + lists.tile_begin[tile];
  const size_t length = static_cast<size_t>(lists.tile_begin[tile + 1] - lists.tile_begin[tile]);
  const int left = tile_x * kTileSize, top = tile_y * kTileSize;
  const AlphaConstants constants(raster);
  out.splats.resize(kGather);
  out.lists.resize(kStrips * kListLength);
  out.strips.resize(length);
  if (length > 0) std::memset(out.strips.data(), 0, length * sizeof(uint16_t));
  bool open[kStrips] = {};
  for (int b = 0; b < kTileBlocks; ++b) {
    BlockMaps& maps = out.blocks[b];
    std::memset(static_cast<void*>(&maps), 0, sizeof maps);
    const int x = left + (b & 1) * kBlockSize, y = top + (b >> 1) * kBlockSize;
    for (int i = 0; i < kBlockPixels; ++i) {
      const bool inside = x + i % kBlockSize < view.width && y + i / kBlockSize < view.height;
      maps.transmittance[i] = inside ? 1.0f : -1.0f;
      open[b * kBlockStrips + i / kStripPixels] |= inside;
    }
  }
  bool any = true;
  for (size_t first = 0; first < length && any; first += kGather) {
    const size_t n = HWY_MIN(kGather, length - first);
    for (size_t i = 0; i < n; ++i) {
      const size_t ahead = first + i + kPrefetch;
      if (ahead < length) {
        const char* next = reinterpret_cast<const char*>(&view.splats[list[ahead]]);
        hwy::Prefetch(next);
        hwy::Prefetch(next + 64);
      }
      out.splats[i] = view.splats[list[first + i]];
    }
    size_t counts[kStrips] = {};
    list_strips(out.splats.data(), n, static_cast<float>(left), static_cast<float>(top), open, out.lists.data(),
                counts);
    const GatheredSplats batch{out.splats.data(), out.strips.data() + first, static_cast<int32_t>(first) + 1};
    any = false;
    for (int strip = 0; strip < kStrips; ++strip) {
      if (!open[strip]) continue;
      const int b = strip / kBlockStrips;
      const int x = left + (b & 1) * kBlockSize, y = top + (b >> 1) * kBlockSize;
      const size_t begin = static_cast<size_t>(strip % kBlockStrips * kStripPixels);
      bool still = false;
      for (size_t at = begin; at < begin + kStripPixels; at += kLanes) {
        const uint32_t* const reached = out.lists.data() + strip * kListLength;
        if constexpr (kMaps == BlendedMaps::kMedian) {
          still |=
              find_medians<kSmooth>(batch, reached, counts[strip], constants, view.camera, x, y, at, out.blocks[b]);
        } else {
          still |= blend_pixels<kMaps, kSmooth>(batch, reached, counts[strip], constants, view.camera, x, y, at,
                                                1u << strip, out.blocks[b]);
        }
      }
      open[strip] = still;
      any |= still;
    }
    if (seen == nullptr) continue;
    for (size_t i = 0; i < n; ++i) {
      const Splat& g = out.splats[i];
      if (batch.strips[i] != 0) seen[g.slot_origin + int64_t(tile_y) * g.slot_stride + tile_x] = 1;
    }
  }
  const FloatTag d;
  for (BlockMaps& maps : out.blocks) {
    for (size_t at = 0; at < kBlockPixels; at += kLanes) {
      const FloatVec t = hn::Abs(hn::Load(d, maps.transmittance + at));
      hn::Store(t, d, maps.transmittance + at);
      for (int k = 0; k < 3; ++k) {
        const FloatVec color = hn::Load(d, maps.color[k] + at);
        hn::Store(hn::MulAdd(t, hn::Set(d, raster.background[k]), color), d, maps.color[k] + at);
      }
    }
  }
}

void BlendTileForward(const ProjectedView& view, const TileLists& lists, int tile_x, int tile_y,
                      const RasterSettings& raster, BlendedMaps maps, uint8_t* seen, TileForward& out) {
  if (maps == BlendedMaps::kMedian) {
    if (raster.smooth_cutoff) {
      blend_tile<BlendedMaps::kMedian, true>(view, lists, tile_x, tile_y, raster, seen, out);
    } else {
      blend_tile<BlendedMaps::kMedian, false>(view, lists, tile_x, tile_y, raster, seen, out);
    }
  } else if (raster.smooth_cutoff) {  // for tests: one version that computes everything
    blend_tile<BlendedMaps::kAll, true>(view, lists, tile_x, tile_y, raster, seen, out);
  } else if (maps == BlendedMaps::kAll) {
    blend_tile<BlendedMaps::kAll, false>(view, lists, tile_x, tile_y, raster, seen, out);
  } else if (maps == BlendedMaps::kLosses) {
    blend_tile<BlendedMaps::kLosses, false>(view, lists, tile_x, tile_y, raster, seen, out);
  } else {
    blend_tile<BlendedMaps::kColor, false>(view, lists, tile_x, tile_y, raster, seen, out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(BlendTileForward);

void blend_tile_forward(const ProjectedView& view, const TileLists& lists, int tile_x, int tile_y,
                        const RasterSettings& raster, BlendedMaps maps, uint8_t* seen, TileForward& out) {
  HWY_DYNAMIC_DISPATCH(BlendTileForward)(view, lists, tile_x, tile_y, raster, maps, seen, out);
}

}  // namespace aligngs::cpu
#endif
