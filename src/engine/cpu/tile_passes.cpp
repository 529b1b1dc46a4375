#include "engine/cpu/tile_passes.h"

#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/error.h"
#include "core/memory_budget.h"
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

void size_maps(int width, int height, bool geometry, RenderMaps<float>& maps) {
  const size_t n = size_t(width) * height;
  maps.width = width;
  maps.height = height;
  maps.color.resize(3 * n);
  maps.alpha.resize(n);
  for (auto [plane, count] : {std::pair<std::vector<float>*, size_t>{&maps.normal, 3 * n},
                              {&maps.distance, n},
                              {&maps.expected, n},
                              {&maps.median, n}}) {
    if (geometry) {
      plane->resize(count);
    } else {
      plane->assign(count, 0.0f);
    }
  }
}

void load_gradients(const BlockWeights& block, const ProjectedView& view, const BackwardMaps& maps, bool geometry,
                    bool density, BlockGradients& out) {
  const BlockClip c = clip(block.x, block.y, view.width, view.height);
  // Beyond the image, and where a map is not given, everything is zero.
  const bool whole = c.width == kBlockSize && c.height == kBlockSize;
  if (!whole || !geometry || !density || maps.prior == nullptr) std::memset(static_cast<void*>(&out), 0, sizeof out);
  const size_t n = size_t(view.width) * view.height;
  for (int k = 0; k < 3; ++k) read_block(maps.gradients.color.data() + k * n, c, view.width, out.color[k]);
  if (geometry) {
    for (int k = 0; k < 3; ++k) read_block(maps.gradients.normal.data() + k * n, c, view.width, out.normal[k]);
    read_block(maps.gradients.distance.data(), c, view.width, out.distance);
    read_block(maps.gradients.alpha.data(), c, view.width, out.alpha);
  }
  if (density) {
    read_block(maps.residual, c, view.width, out.residual);
    if (maps.prior != nullptr) {
      read_block(maps.prior, c, view.width, out.prior);
      for (float& z : out.prior) z = is_finite(z) ? z * maps.prior_scale : 0.0f;
    }
  }
}

/// Adds the time it lives to the thread's semantic seconds.
class SemanticTimer {
 public:
  explicit SemanticTimer(TileScratch& s) : s_(s) {}
  ~SemanticTimer() {
    s_.semantic_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  TileScratch& s_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Leaves the tile's sums at the slots of its Gaussians. One that was blended has a positive weight.
void store_slots(int tile_x, int tile_y, const TileScratch& s, SlotGradients& out) {
  constexpr size_t kAhead = 8;  ///< slots lie anywhere in memory: each is asked for while this many are written
  const auto slot_of = [&](size_t i) {
    const Splat& splat = s.weights.splats[i];
    return static_cast<size_t>(splat.slot_origin + int64_t(tile_y) * splat.slot_stride + tile_x);
  };
  for (size_t i = 0; i < s.weights.count; ++i) {
    if (i + kAhead < s.weights.count) {
      const char* next = reinterpret_cast<const char*>(out.slots.data() + slot_of(i + kAhead));
      __builtin_prefetch(next, 1);
      __builtin_prefetch(next + 64, 1);
    }
    if (!(s.sums[i].weight > 0)) continue;
    const size_t slot = slot_of(i);
    out.used[slot] = 1;
    out.slots[slot] = s.sums[i];
  }
}

/// Slots of a view whose Gaussians grew without bound may not fit: an error that says so rather than a killed process.
void size_slots(size_t instances, SlotGradients& out) {
  constexpr uint64_t kWorthAsking = uint64_t(1) << 30;  // bytes; smaller growth is not worth reading the system's state
  const uint64_t bytes = uint64_t(instances) * (sizeof(SplatGradient) + 1);
  if (instances > out.slots.size() && bytes > kWorthAsking + out.slots.capacity_bytes() &&
      bytes > available_memory_bytes()) {
    throw_resources({}, std::to_string(instances) + " (Gaussian, tile) pairs in one view need " +
                            std::to_string(bytes >> 20) + " MB",
                    "limit the size of the Gaussians (scale limit) or their number");
  }
  out.slots.resize(instances);
  out.used.assign(instances, 0);
}

}  // namespace

void forward_pass(const ViewTiles& tiles, bool geometry, ThreadPool& pool, std::vector<TileScratch>& scratch,
                  RenderMaps<float>& maps) {
  const ProjectedView& view = tiles.view;
  size_maps(view.width, view.height, geometry, maps);
  const size_t n = maps.pixels();
  pool.parallel_for(view.tiles(), kTilesPerTask, [&](size_t begin, size_t end, int worker) {
    TileForward& s = scratch[static_cast<size_t>(worker)].forward;
    for (size_t tile = begin; tile < end; ++tile) {
      const int tile_x = static_cast<int>(tile) % view.tiles_x, tile_y = static_cast<int>(tile) / view.tiles_x;
      blend_tile_forward(view, tiles.lists, tile_x, tile_y, tiles.raster, geometry, s);
      for (int b = 0; b < kTileBlocks; ++b) {
        const BlockClip c = clip(tile_x * kTileSize + (b & 1) * kBlockSize, tile_y * kTileSize + (b >> 1) * kBlockSize,
                                 view.width, view.height);
        if (c.width == 0 || c.height == 0) continue;
        const BlockMaps& block = s.blocks[b];
        for (int k = 0; k < 3; ++k) write_block(block.color[k], c, view.width, maps.color.data() + k * n);
        write_block(block.alpha, c, view.width, maps.alpha.data());
        if (!geometry) continue;
        for (int k = 0; k < 3; ++k) write_block(block.normal[k], c, view.width, maps.normal.data() + k * n);
        write_block(block.distance, c, view.width, maps.distance.data());
        write_block(block.expected, c, view.width, maps.expected.data());
        write_block(block.median, c, view.width, maps.median.data());
      }
    }
  });
}

void backward_pass(const ViewTiles& tiles, const BackwardMaps& maps, bool geometry, bool density,
                   SemanticPass* semantics, ThreadPool& pool, std::vector<TileScratch>& scratch, RowBatches& batches,
                   SlotGradients& out) {
  const ProjectedView& view = tiles.view;
  size_slots(tiles.lists.instances(), out);
  std::vector<double> soft(semantics != nullptr ? view.tiles() : 0), hard(soft.size());
  const auto visit = [&](size_t tile, int worker, TileRows* rows) {
    TileScratch& s = scratch[static_cast<size_t>(worker)];
    const int tile_x = static_cast<int>(tile) % view.tiles_x, tile_y = static_cast<int>(tile) / view.tiles_x;
    compute_tile_weights(view, tiles.lists, tile_x, tile_y, tiles.raster, s.weights);
    s.sums.resize(s.weights.count);
    if (s.weights.count > 0) {
      std::memset(static_cast<void*>(s.sums.data()), 0, s.weights.count * sizeof(SplatGradient));
    }
    std::optional<SemanticVisit> semantic;
    if (semantics != nullptr) {
      const SemanticTimer timer(s);
      semantic.emplace(*semantics, s.weights, *rows, s.semantic);
    }
    for (int b = 0; b < kTileBlocks; ++b) {
      const BlockWeights& block = s.weights.blocks[b];
      BackwardOptions options{geometry, density, nullptr};
      if (semantic) {
        const SemanticTimer timer(s);
        options.coupling = semantic->visit_block(b);
        soft[tile] += s.semantic.block.soft;
        hard[tile] += s.semantic.block.hard;
      }
      if (block.count == 0) continue;
      load_gradients(block, view, maps, geometry, density, s.gradients);
      blend_block_backward(s.weights, block, view.camera, tiles.raster, s.gradients, options, s.sums.data());
    }
    if (semantic) {
      const SemanticTimer timer(s);
      semantic->finish();
    }
    store_slots(tile_x, tile_y, s, out);
  };
  if (semantics == nullptr) {
    pool.parallel_for(view.tiles(), 1, [&](size_t begin, size_t end, int worker) {
      for (size_t tile = begin; tile < end; ++tile) visit(tile, worker, nullptr);
    });
    return;
  }
  semantics->written->assign(semantics->visible, 0);
  const RowSums sums{semantics->step.padded, semantics->rank, semantics->visible, semantics->gradients,
                     semantics->written};
  batches.run(view, tiles.lists, sums, pool,
              [&](size_t tile, int worker, TileRows& rows) { visit(tile, worker, &rows); });
  semantics->soft = semantics->hard = 0;
  for (size_t tile = 0; tile < soft.size(); ++tile) {
    semantics->soft += soft[tile];
    semantics->hard += hard[tile];
  }
  semantics->soft /= static_cast<double>(semantics->step.cache->valid);
  semantics->hard /= static_cast<double>(semantics->step.cache->valid);
}

void lift_pass(const ViewTiles& tiles, const SemanticStep& step, ThreadPool& pool, std::vector<TileScratch>& scratch,
               RowBatches& batches, float* sums, std::vector<uint8_t>& written) {
  const ProjectedView& view = tiles.view;
  batches.run(
      view, tiles.lists, {step.padded, nullptr, view.size(), sums, &written}, pool,
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
