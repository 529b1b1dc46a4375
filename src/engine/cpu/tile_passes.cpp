#include "engine/cpu/tile_passes.h"

#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/huge_pages.h"
#include "core/memory_budget.h"
#include "core/steady_seconds.h"
#include "engine/cpu/tile_products.h"

namespace aligngs::cpu {
namespace {

/// The part of a block that lies inside the image.
struct BlockClip {
  int x, y, width, height;
};
BlockClip clip(int x, int y, int width, int height) {
  return {x, y, std::max(0, std::min(kBlockSize, width - x)), std::max(0, std::min(kBlockSize, height - y))};
}

constexpr size_t kTilesPerTask = 4;  ///< neighbours write to the same cache lines of a map

constexpr size_t kRowBytes = kBlockSize * sizeof(float);

void write_block(const float* block, const BlockClip& c, int stride, float* plane) {
  float* to = plane + size_t(c.y) * stride + c.x;
  if (c.width == kBlockSize && c.height == kBlockSize) {  // of a size the compiler knows: no call
    for (int y = 0; y < kBlockSize; ++y) std::memcpy(to + size_t(y) * stride, block + y * kBlockSize, kRowBytes);
    return;
  }
  for (int y = 0; y < c.height; ++y) {
    std::memcpy(to + size_t(y) * stride, block + y * kBlockSize, c.width * sizeof(float));
  }
}

/// Copies what lies inside; the rest of the block keeps its zeros.
void read_block(const float* plane, const BlockClip& c, int stride, float* block) {
  const float* from = plane + size_t(c.y) * stride + c.x;
  if (c.width == kBlockSize && c.height == kBlockSize) {
    for (int y = 0; y < kBlockSize; ++y) std::memcpy(block + y * kBlockSize, from + size_t(y) * stride, kRowBytes);
    return;
  }
  for (int y = 0; y < c.height; ++y) {
    std::memcpy(block + y * kBlockSize, from + size_t(y) * stride, c.width * sizeof(float));
  }
}

/// Asks for the tile's part of a plane before it is needed.
template <int kWrite>
void prefetch_tile(const float* plane, const ProjectedView& view, int tile_x, int tile_y) {
  const int end = std::min((tile_y + 1) * kTileSize, view.height);
  for (int y = tile_y * kTileSize; y < end; ++y) {
    __builtin_prefetch(plane + size_t(y) * view.width + tile_x * kTileSize, kWrite);
  }
}

void size_map(size_t count, std::vector<float>& map) {
  const bool grows = map.capacity() < count;
  map.resize(count);
  if (grows) ask_for_huge_pages(map);
}

void size_maps(int width, int height, BlendedMaps blended, RenderMaps<float>& maps) {
  const size_t n = size_t(width) * height;
  maps.width = width;
  maps.height = height;
  size_map(3 * n, maps.color);
  size_map(n, maps.alpha);
  const auto size_or_clear = [](bool given, size_t count, std::vector<float>& map) {
    if (given) {
      size_map(count, map);
    } else {
      map.assign(count, 0.0f);
    }
  };
  size_or_clear(has_geometry(blended), 3 * n, maps.normal);
  size_or_clear(has_geometry(blended), n, maps.distance);
  size_or_clear(has_geometry(blended), n, maps.expected);
  if (has_median(blended)) size_map(n, maps.median);
}

void load_gradients(const TileWeights& tile, const ProjectedView& view, const BackwardMaps& maps, bool geometry,
                    bool density, TileGradients& out) {
  const BlockWeights& corner = tile.blocks[0];
  const bool whole = corner.x + kTileSize <= view.width && corner.y + kTileSize <= view.height;
  // Beyond the image, and where a map is not given, everything is zero.
  if (!whole || !geometry || !density || maps.prior == nullptr) std::memset(static_cast<void*>(&out), 0, sizeof out);
  const size_t n = size_t(view.width) * view.height;
  for (int b = 0; b < kTileBlocks; ++b) {
    const BlockClip c = clip(tile.blocks[b].x, tile.blocks[b].y, view.width, view.height);
    const auto read = [&](const float* plane, float* to) { read_block(plane, c, view.width, to + b * kBlockPixels); };
    for (int k = 0; k < 3; ++k) read(maps.gradients.color.data() + k * n, out.color[k]);
    if (geometry) {
      for (int k = 0; k < 3; ++k) read(maps.gradients.normal.data() + k * n, out.normal[k]);
      read(maps.gradients.distance.data(), out.distance);
      read(maps.gradients.alpha.data(), out.alpha);
    }
    if (density) {
      read(maps.residual, out.residual);
      if (maps.prior != nullptr) read(maps.prior, out.prior);
    }
  }
  if (!density || maps.prior == nullptr) return;
  for (float& z : out.prior) z = is_finite(z) ? z * maps.prior_scale : 0.0f;
}

/// Adds the time it lives to the thread's semantic seconds.
class SemanticTimer {
 public:
  explicit SemanticTimer(TileScratch& s) : s_(s) {}
  ~SemanticTimer() { s_.semantic_seconds += steady_seconds() - start_; }

 private:
  TileScratch& s_;
  double start_ = steady_seconds();
};

/// Copies what the forward pass noted of a tile whose list begins at `begin`.
void keep_record(const TileForward& s, size_t tile, size_t begin, BlendRecord& out) {
  if (s.strips.size() > 0) {
    std::memcpy(out.strips.data() + begin, s.strips.data(), s.strips.size() * sizeof(uint16_t));
  }
  for (int b = 0; b < kTileBlocks; ++b) {
    std::memcpy(out.last.data() + tile * kTilePixels + b * kBlockPixels, s.blocks[b].last, sizeof s.blocks[b].last);
  }
}

/// Slots of a view whose Gaussians grew without bound may not fit: a clear error rather than a killed process.
void size_slots(size_t instances, SlotGradients& out) {
  constexpr uint64_t kWorthAsking = uint64_t(1) << 30;  // bytes; smaller growth is not worth reading the system's state
  const uint64_t bytes = uint64_t(instances) * sizeof(CoupledSplatGradient);
  if (instances > out.size() && bytes > kWorthAsking + out.capacity_bytes() && bytes > available_memory_bytes()) {
    throw_resources(
        {},
        std::to_string(instances) + " (Gaussian, tile) pairs in one view need " + std::to_string(bytes >> 20) + " MB",
        "limit the size of the Gaussians (scale limit) or their number");
  }
  out.resize(instances);
}

}  // namespace

void forward_pass(const ViewTiles& tiles, BlendedMaps blended, ThreadPool& pool, std::vector<TileScratch>& scratch,
                  RenderMaps<float>& maps, BlendRecord* record) {
  const ProjectedView& view = tiles.view;
  const bool geometry = has_geometry(blended), median_alone = blended == BlendedMaps::kMedian;
  if (median_alone) {
    maps.width = view.width;
    maps.height = view.height;
    size_map(size_t(view.width) * view.height, maps.median);
  } else {
    size_maps(view.width, view.height, blended, maps);
  }
  if (record != nullptr) {
    record->strips.resize(tiles.lists.instances());
    record->seen.assign(tiles.lists.instances(), 0);
    record->last.resize(view.tiles() * kTilePixels);
  }
  const size_t n = maps.pixels();
  std::vector<const std::vector<float>*> written{&maps.median};
  if (!median_alone) written = {&maps.color, &maps.alpha};
  if (geometry) written.insert(written.end(), {&maps.normal, &maps.distance, &maps.expected});
  if (blended == BlendedMaps::kAll) written.push_back(&maps.median);
  pool.parallel_for(view.tiles(), kTilesPerTask, [&](size_t begin, size_t end, int worker) {
    TileForward& s = scratch[static_cast<size_t>(worker)].forward;
    for (size_t tile = begin; tile < end; ++tile) {
      const int tile_x = static_cast<int>(tile) % view.tiles_x, tile_y = static_cast<int>(tile) / view.tiles_x;
      for (const std::vector<float>* map : written) {
        for (size_t at = 0; at < map->size(); at += n) prefetch_tile<1>(map->data() + at, view, tile_x, tile_y);
      }
      blend_tile_forward(view, tiles.lists, tile_x, tile_y, tiles.raster, blended,
                         record != nullptr ? record->seen.data() : nullptr, s);
      if (record != nullptr) keep_record(s, tile, static_cast<size_t>(tiles.lists.tile_begin[tile]), *record);
      for (int b = 0; b < kTileBlocks; ++b) {
        const BlockClip c = clip(tile_x * kTileSize + (b & 1) * kBlockSize, tile_y * kTileSize + (b >> 1) * kBlockSize,
                                 view.width, view.height);
        if (c.width == 0 || c.height == 0) continue;
        const BlockMaps& block = s.blocks[b];
        if (has_median(blended)) write_block(block.median, c, view.width, maps.median.data());
        if (median_alone) continue;
        for (int k = 0; k < 3; ++k) write_block(block.color[k], c, view.width, maps.color.data() + k * n);
        write_block(block.alpha, c, view.width, maps.alpha.data());
        if (!geometry) continue;
        for (int k = 0; k < 3; ++k) write_block(block.normal[k], c, view.width, maps.normal.data() + k * n);
        write_block(block.distance, c, view.width, maps.distance.data());
        write_block(block.expected, c, view.width, maps.expected.data());
      }
    }
  });
}

void backward_pass(const ViewTiles& tiles, const BlendRecord& record, const BackwardMaps& maps, bool geometry,
                   bool density, SemanticPass* semantics, ThreadPool& pool, std::vector<TileScratch>& scratch,
                   RowBatches& batches, SlotGradients& out) {
  const ProjectedView& view = tiles.view;
  size_slots(tiles.lists.instances(), out);
  std::vector<double> soft(semantics != nullptr ? view.tiles() : 0), hard(soft.size());
  const auto visit = [&](size_t tile, int worker, TileRows* rows) {
    TileScratch& s = scratch[static_cast<size_t>(worker)];
    const int tile_x = static_cast<int>(tile) % view.tiles_x, tile_y = static_cast<int>(tile) / view.tiles_x;
    const size_t n = size_t(view.width) * view.height;
    for (const std::vector<float>* map :
         {&maps.gradients.color, &maps.gradients.normal, &maps.gradients.distance, &maps.gradients.alpha}) {
      if (!geometry && map != &maps.gradients.color) continue;
      for (size_t at = 0; at < map->size(); at += n) prefetch_tile<0>(map->data() + at, view, tile_x, tile_y);
    }
    recompute_tile_weights(view, tiles.lists, tile_x, tile_y, tiles.raster, record, s.weights);
    BackwardOptions options;
    options.geometry = geometry;
    options.density = density;
    if (semantics != nullptr) {
      const SemanticTimer timer(s);
      SemanticVisit semantic(*semantics, s.weights, *rows, s.semantic);
      for (int b = 0; b < kTileBlocks; ++b) {
        options.coupling[b] = semantic.visit_block(b);
        soft[tile] += s.semantic.block.soft;
        hard[tile] += s.semantic.block.hard;
      }
      semantic.finish();
      options.coupling_rows = semantic.coupling_rows();
    }
    if (s.weights.count == 0) return;
    load_gradients(s.weights, view, maps, geometry, density, s.gradients);
    blend_tile_backward(s.weights, view.camera, tiles.raster, s.gradients, options, {out.data(), tile_x, tile_y});
  };
  if (semantics == nullptr) {
    pool.parallel_for(view.tiles(), 1, [&](size_t begin, size_t end, int worker) {
      for (size_t tile = begin; tile < end; ++tile) visit(tile, worker, nullptr);
    });
    return;
  }
  semantics->written->assign(semantics->visible, 0);
  const RowSumTarget sums{semantics->step.padded, semantics->rank, semantics->visible, semantics->gradients,
                          semantics->written};
  semantics->harmless = batches.run(view, tiles.lists, sums, pool,
                                    [&](size_t tile, int worker, TileRows& rows) { visit(tile, worker, &rows); });
  semantics->soft = semantics->hard = 0;
  for (size_t tile = 0; tile < soft.size(); ++tile) {
    semantics->soft += soft[tile];
    semantics->hard += hard[tile];
  }
  const double pixel_weight = static_cast<double>(semantics->step.losses->semantic_sample.scale()) /
                              static_cast<double>(semantics->step.cache->valid);
  semantics->soft *= pixel_weight;
  semantics->hard *= pixel_weight;
}

void lift_pass(const ViewTiles& tiles, const SemanticStep& step, ThreadPool& pool, std::vector<TileScratch>& scratch,
               RowBatches& batches, float* sums, std::vector<uint8_t>& written) {
  const ProjectedView& view = tiles.view;
  batches.run(view, tiles.lists, {step.padded, nullptr, view.size(), sums, &written}, pool,
              [&](size_t tile, int worker, TileRows& rows) {
                TileScratch& s = scratch[static_cast<size_t>(worker)];
                compute_tile_weights(view, tiles.lists, static_cast<int>(tile) % view.tiles_x,
                                     static_cast<int>(tile) / view.tiles_x, tiles.raster, s.weights);
                s.semantic.tile_rows.assign(s.weights.count, nullptr);
                s.semantic.block.blended.resize(kBlockPixels * step.padded);
                for (const BlockWeights& block : s.weights.blocks) {
                  if (block.count == 0) continue;
                  bool any = false;
                  for (int i = 0; i < kBlockPixels; ++i) {
                    const int x = block.x + i % kBlockSize, y = block.y + i / kBlockSize;
                    float* teacher = s.semantic.block.blended.data() + i * step.padded;
                    const bool valid = x < view.width && y < view.height && sample_teacher_padded(step, x, y, teacher);
                    if (!valid) std::memset(teacher, 0, step.padded * sizeof(float));
                    any |= valid;
                  }
                  if (!any) continue;
                  collect_row_gradients(block, s.weights, rows, s.semantic);
                  order_by_strips(block, s.semantic.strips);
                  block_row_gradients(block, s.semantic.strips, s.semantic.block.blended.data(), step.padded,
                                      s.semantic.row_gradients.data());
                }
              });
}

}  // namespace aligngs::cpu
