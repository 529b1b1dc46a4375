// How much there is to blend in a view: the numbers that decide what a step costs.
#pragma once

#include <cstddef>

#include "core/thread_pool.h"
#include "engine/settings.h"
#include "gaussians/gaussian_model.h"
#include "scene/camera.h"

namespace aligngs::cpu {

struct TileStatistics {
  size_t gaussians = 0, pixels = 0, tiles = 0;
  size_t visible = 0;       ///< Gaussians whose rectangle holds a tile
  size_t pairs = 0;         ///< (Gaussian, tile) pairs
  size_t max_per_tile = 0;  ///< pairs of the fullest tile
  size_t used = 0;          ///< pairs blended before the last pixel of their tile is closed
  size_t entries = 0;       ///< (Gaussian, block of 8 x 8 pixels) pairs with a weight
  size_t active = 0;        ///< (Gaussian, pixel) pairs with a weight
};

TileStatistics tile_statistics(const GaussianModel& model, const Camera& camera, const RasterSettings& raster,
                               ThreadPool& pool);

}  // namespace aligngs::cpu
