#include "engine/cpu/tile_statistics.h"

#include <algorithm>
#include <vector>

#include "engine/cpu/binning.h"
#include "engine/cpu/project.h"
#include "engine/cpu/tile_weights.h"

namespace aligngs::cpu {

TileStatistics tile_statistics(const GaussianModel& model, const Camera& camera, const RasterSettings& raster,
                               ThreadPool& pool) {
  ProjectedView view;
  TileLists lists;
  project_view(model, camera, raster, model.sh_degree, pool, view);
  build_tile_lists(view, pool, lists);
  struct TileCounts {
    size_t used = 0, entries = 0, active = 0;
  };
  std::vector<TileCounts> counts(view.tiles());
  std::vector<TileWeights> scratch(static_cast<size_t>(pool.size()));
  pool.parallel_for(view.tiles(), 1, [&](size_t begin, size_t end, int worker) {
    TileWeights& weights = scratch[static_cast<size_t>(worker)];
    for (size_t tile = begin; tile < end; ++tile) {
      compute_tile_weights(view, lists, static_cast<int>(tile) % view.tiles_x, static_cast<int>(tile) / view.tiles_x,
                           raster, weights);
      std::vector<uint8_t> blended(weights.count, 0);
      for (const BlockWeights& block : weights.blocks) {
        counts[tile].entries += block.count;
        for (size_t e = 0; e < block.count; ++e) blended[block.entry[e]] = 1;
        const float* w = block.weight.data();
        counts[tile].active += static_cast<size_t>(
            std::count_if(w, w + block.count * kBlockPixels, [](float weight) { return weight > 0; }));
      }
      counts[tile].used += static_cast<size_t>(std::count(blended.begin(), blended.end(), 1));
    }
  });
  TileStatistics out;
  out.gaussians = model.size();
  out.pixels = size_t(view.width) * view.height;
  out.tiles = view.tiles();
  out.visible = lists.visible.size();
  out.pairs = lists.instances();
  for (size_t tile = 0; tile < out.tiles; ++tile) {
    out.max_per_tile =
        std::max(out.max_per_tile, static_cast<size_t>(lists.tile_begin[tile + 1] - lists.tile_begin[tile]));
    out.used += counts[tile].used;
    out.entries += counts[tile].entries;
    out.active += counts[tile].active;
  }
  return out;
}

}  // namespace aligngs::cpu
