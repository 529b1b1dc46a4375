// The weights that the backward pass recomputes are those of the forward pass, bit for bit.
#include "engine/cpu/simd_targets.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstring>

#include "engine/cpu/project.h"
#include "engine/cpu/tile_passes.h"
#include "engine/testing/scenes.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

/// Weights of a block by (row of the model, pixel), zero where there is none.
std::vector<float> by_row(const TileWeights& tile, const BlockWeights& block, size_t rows) {
  std::vector<float> out(rows * kBlockPixels, 0.0f);
  for (size_t e = 0; e < block.count; ++e) {
    std::memcpy(&out[tile.rows[block.entry[e]] * size_t(kBlockPixels)], block.weight.data() + e * kBlockPixels,
                kBlockPixels * sizeof(float));
  }
  return out;
}

void expect_same_weights(const RandomSceneOptions& o, const RasterSettings& raster) {
  ThreadPool pool(2);
  const GaussianModel model = make_model(o);
  ProjectedView view;
  TileLists lists;
  project_view(model, make_camera(o.width, o.height), raster, 3, pool, view);
  build_tile_lists(view, pool, lists);
  std::vector<TileScratch> scratch(2);
  RenderMaps<float> maps;
  BlendRecord record;
  forward_pass({view, lists, raster}, BlendedMaps::kAll, pool, scratch, maps, &record);
  TileWeights whole, again;
  for (int y = 0; y < view.tiles_y; ++y) {
    for (int x = 0; x < view.tiles_x; ++x) {
      compute_tile_weights(view, lists, x, y, raster, whole);
      recompute_tile_weights(view, lists, x, y, raster, record, again);
      for (int b = 0; b < kTileBlocks; ++b) {
        ASSERT_EQ(again.blocks[b].count, whole.blocks[b].count) << x << " " << y << " " << b;
        EXPECT_EQ(by_row(again, again.blocks[b], model.size()), by_row(whole, whole.blocks[b], model.size()));
        EXPECT_EQ(0, std::memcmp(again.blocks[b].transmittance, whole.blocks[b].transmittance,
                                 sizeof whole.blocks[b].transmittance));
      }
      for (size_t i = 0; i < again.count; ++i) {
        const Splat& g = again.splats[i];
        EXPECT_EQ(1, record.seen[static_cast<size_t>(g.slot_origin + int64_t(y) * g.slot_stride + x)]);
      }
    }
  }
}

TEST(RecomputedWeights, EqualThoseOfTheForwardPass) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    SCOPED_TRACE(hwy::TargetName(target));
    RandomSceneOptions o;
    o.gaussians = 600;
    RasterSettings raster;
    expect_same_weights(o, raster);
    raster.smooth_cutoff = true;
    expect_same_weights(o, raster);
    RandomSceneOptions opaque = o;  // most pixels close
    opaque.log_scale_min = -2;
    opaque.log_scale_max = -0.5;
    opaque.logit_min = 3;
    opaque.logit_max = 9;
    expect_same_weights(opaque, RasterSettings());
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(RecomputedWeights, NothingInViewLeavesNothing) {
  RandomSceneOptions o;
  o.gaussians = 0;
  expect_same_weights(o, RasterSettings());
}

}  // namespace
}  // namespace aligngs::cpu
