// Sums of whole numbers over tiles: exact in float32, so that every order gives the same.
#include "engine/cpu/row_batches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/random.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kPadded = 16;
constexpr float kUntouched = -7;  ///< what destinations hold before

/// Gaussians with the rectangles that a test wants, one behind the other.
struct Rectangles {
  ProjectedView view;
  TileLists lists;

  Rectangles(int tiles_x, int tiles_y, const std::vector<TileRect>& rects, ThreadPool& pool) {
    view.tiles_x = tiles_x;
    view.tiles_y = tiles_y;
    view.width = tiles_x * kTileSize;
    view.height = tiles_y * kTileSize;
    view.rects = rects;
    view.radius.resize(rects.size());
    view.splats.resize(rects.size());
    for (size_t i = 0; i < rects.size(); ++i) {
      view.splats[i] = Splat{};
      view.splats[i].z = 1.0f + static_cast<float>(i);
    }
    build_tile_lists(view, pool, lists);
  }
};

/// Rectangles of one tile to the whole image, and culled ones.
std::vector<TileRect> random_rectangles(int tiles_x, int tiles_y, size_t count) {
  Random random(5);
  std::vector<TileRect> rects(count);
  for (TileRect& r : rects) {
    if (random.chance(0.1)) continue;
    const int wide = random.chance(0.1) ? tiles_x : 1 + static_cast<int>(random.uniform(0, 4));
    const int x = static_cast<int>(random.uniform(0, tiles_x)), y = static_cast<int>(random.uniform(0, tiles_y));
    r = {static_cast<uint16_t>(x), static_cast<uint16_t>(y), static_cast<uint16_t>(std::min(tiles_x, x + wide)),
         static_cast<uint16_t>(std::min(tiles_y, y + wide))};
  }
  return rects;
}

/// The tile's term of channel c of the Gaussian's row; every third tile does not ask for it.
float term(size_t tile, uint32_t gaussian, size_t c) { return static_cast<float>((tile * 7 + gaussian * 3 + c) % 11); }
bool asks(size_t tile, uint32_t gaussian) { return (tile + gaussian) % 3 != 0; }

void check(const Rectangles& scene, int threads) {
  ThreadPool pool(threads);
  const size_t n = scene.view.size();
  std::vector<float> want(n * kPadded, kUntouched);
  AlignedArray<float> destination;
  destination.resize(n * kPadded);
  for (size_t i = 0; i < n * kPadded; ++i) destination[i] = kUntouched;
  std::vector<uint8_t> written(n, 0), want_written(n, 0);
  const size_t tiles_x = static_cast<size_t>(scene.view.tiles_x);
  for (size_t i = 0; i < n; ++i) {
    const TileRect& r = scene.view.rects[i];
    for (size_t y = r.y0; y < r.y1; ++y) {
      for (size_t tile = y * tiles_x + r.x0; tile < y * tiles_x + r.x1; ++tile) {
        if (!asks(tile, static_cast<uint32_t>(i))) continue;
        for (size_t c = 0; c < kPadded; ++c) {
          float& sum = want[i * kPadded + c];
          sum = (want_written[i] != 0 ? sum : 0.0f) + term(tile, static_cast<uint32_t>(i), c);
        }
        want_written[i] = 1;
      }
    }
  }
  RowBatches batches;
  RowSumTarget sums;
  sums.padded = kPadded;
  sums.targets = n;
  sums.destination = destination.data();
  sums.written = &written;
  const bool harmless = batches.run(scene.view, scene.lists, sums, pool, [&](size_t tile, int, TileRows& rows) {
    for (uint64_t k = scene.lists.tile_begin[tile]; k < scene.lists.tile_begin[tile + 1]; ++k) {
      const uint32_t gaussian = scene.lists.gaussians[k];
      if (!asks(tile, gaussian)) continue;
      float* row = rows.sums_of(gaussian);
      for (size_t c = 0; c < kPadded; ++c) row[c] += term(tile, gaussian, c);
    }
  });
  EXPECT_TRUE(harmless);
  EXPECT_EQ(written, want_written);
  EXPECT_TRUE(std::equal(want.begin(), want.end(), destination.data()));
}

TEST(RowBatches, GroupsOfEverySize) {
  ThreadPool pool(1);
  const struct {
    int tiles_x, tiles_y, group;
  } images[] = {{3, 2, 1}, {20, 15, 2}, {40, 30, 4}, {41, 31, 4}};  // 640 x 480 is 40 x 30
  for (const auto& image : images) {
    EXPECT_EQ(RowBatches::group_size(image.tiles_x, image.tiles_y), image.group);
    const Rectangles scene(image.tiles_x, image.tiles_y, random_rectangles(image.tiles_x, image.tiles_y, 700), pool);
    for (const int threads : {1, 3}) check(scene, threads);
  }
}

TEST(RowBatches, MoreEntriesThanABatchHolds) {
  ThreadPool pool(2);
  const TileRect everywhere{0, 0, 40, 30};
  const Rectangles scene(40, 30, std::vector<TileRect>(1800, everywhere), pool);  // 2.2 million entries
  check(scene, 2);
}

TEST(RowBatches, NoGaussians) {
  ThreadPool pool(1);
  check(Rectangles(5, 4, {}, pool), 1);
  check(Rectangles(5, 4, std::vector<TileRect>(10), pool), 1);
}

TEST(RowBatches, WhatIsNotANumberIsReported) {
  ThreadPool pool(1);
  const Rectangles scene(5, 4, {{1, 1, 2, 2}}, pool);
  AlignedArray<float> destination;
  destination.resize(kPadded);
  std::vector<uint8_t> written(1);
  RowSumTarget sums;
  sums.padded = kPadded;
  sums.targets = 1;
  sums.destination = destination.data();
  sums.written = &written;
  RowBatches batches;
  EXPECT_FALSE(batches.run(scene.view, scene.lists, sums, pool, [&](size_t tile, int, TileRows& rows) {
    if (scene.lists.tile_begin[tile] != scene.lists.tile_begin[tile + 1]) {
      rows.sums_of(0)[3] = std::numeric_limits<float>::quiet_NaN();
    }
  }));
}

}  // namespace
}  // namespace aligngs::cpu
