// The semantic visit to one tile against the formulas in double precision: every way to form the products, on tiles
// made by hand.
#include "engine/cpu/testing/each_instruction_set.h"
#include "engine/cpu/testing/hand_made_tile.h"

#include <hwy/targets.h>

#include "core/error.h"
#include "engine/cpu/matrix_tiles.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

/// The gradient -t / Q of blended probabilities jumps to 0 at the floor of Q. A Q near the floor may be rounded to its
/// other side. With logits this close together every Q stays above. With the rows of TileOptions::trained hardly any
/// does, and a Q within a 128th of the floor may be off by the jump.
constexpr double kAboveTheFloor = 0.5;

class SemanticVisitTile : public ProductsTest {
 protected:
  static void check_products(HandMadeTile& tile) {
    tile.visit(GetParam());
    tile.expect_close(exact() ? kFloat32Tolerance : kBfloat16Tolerance);
  }
  static void check(TileOptions o) {
    SCOPED_TRACE(testing::Message() << o.gaussians << " Gaussians, " << o.channels << " classes, blend " << int(o.blend)
                                    << ", coupling " << int(o.coupling));
    if (!exact() && o.blend == SemanticBlend::kProbabilities && !o.trained) o.spread = kAboveTheFloor;
    HandMadeTile tile(o);
    check_products(tile);
  }
  static void check_every_loss(TileOptions o) {
    for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
      for (const SemanticCoupling coupling :
           {SemanticCoupling::kBounded, SemanticCoupling::kPlain, SemanticCoupling::kOpacity}) {
        o.blend = blend;
        o.coupling = coupling;
        check(o);
      }
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Products, SemanticVisitTile, every_products(), products_name);

TEST_P(SemanticVisitTile, EveryNumberOfClasses) {
  for (const int channels : {1, 2, 7, 16, 17, 33, 40, 150, 151}) {
    TileOptions o;
    o.channels = channels;
    check_every_loss(o);
  }
}

TEST_P(SemanticVisitTile, NoGaussianAndOne) {
  for (const size_t n : {size_t(0), size_t(1)}) {
    TileOptions o;
    o.gaussians = n;
    check_every_loss(o);
  }
}

TEST_P(SemanticVisitTile, GroupsOfEverySize) {
  for (const size_t n : {2, 31, 32, 33, 64, 65, 129}) {
    TileOptions o;
    o.gaussians = n;
    o.channels = 20;
    o.alpha_max = 0.15;
    check_every_loss(o);
  }
}

TEST_P(SemanticVisitTile, TenThousandGaussiansInATile) {
  TileOptions o;
  o.gaussians = 10000;
  o.channels = 31;
  o.reach = 0.2;
  o.alpha_min = 1.0 / 255;
  o.alpha_max = 1.0 / 128;
  check_every_loss(o);
}

TEST_P(SemanticVisitTile, AlphaAtItsThreshold) {
  TileOptions o;
  o.alpha_min = o.alpha_max = 1.0 / 255;
  o.gaussians = 400;
  o.channels = 40;
  check_every_loss(o);
}

TEST_P(SemanticVisitTile, TeacherThatIsSilentInPlaces) {
  TileOptions o;
  o.silent_corner = true;
  o.channels = 7;
  check_every_loss(o);
}

/// Rows as training leaves them: most of what a pixel blends lies at the floor, where there is no gradient.
TEST_P(SemanticVisitTile, PeakedRowsWithMostClassesAtTheFloor) {
  for (const int channels : {150, 151}) {
    TileOptions o;
    o.channels = channels;
    o.trained = true;
    for (const SemanticCoupling coupling :
         {SemanticCoupling::kBounded, SemanticCoupling::kPlain, SemanticCoupling::kOpacity}) {
      SCOPED_TRACE(testing::Message() << channels << " classes, coupling " << int(coupling));
      o.coupling = coupling;
      HandMadeTile tile(o);
      check_products(tile);
      EXPECT_GT(tile.at_floor, tile.classes_seen / 2);
      EXPECT_LT(tile.at_floor, tile.classes_seen);
      EXPECT_LT(tile.beside_floor, tile.classes_seen / 100);
    }
  }
}

/// A tile of a captured room has 415 listed Gaussians. Some 260 are taken before its pixels are full, each by a fifth
/// of the pixels.
TEST_P(SemanticVisitTile, TileOfARealRoom) {
  TileOptions o;
  o.gaussians = 415;
  o.reach = 0.5;  // of the blocks, and of their strips: a quarter of the pixels, of which some are full
  o.alpha_min = 1.0 / 255;
  o.alpha_max = 0.31;
  o.trained = true;
  const HandMadeTile tile(o);
  std::vector<uint8_t> used(o.gaussians, 0);
  double pairs = 0;
  for (const BlockWeights& block : tile.tile.blocks) {
    for (size_t e = 0; e < block.count; ++e) {
      used[block.entry[e]] = 1;
      const float* w = block.weight.data() + e * kBlockPixels;
      pairs += static_cast<double>(std::count_if(w, w + kBlockPixels, [](float x) { return x > 0; }));
    }
  }
  const double taken = static_cast<double>(std::count(used.begin(), used.end(), uint8_t(1)));
  EXPECT_NEAR(taken, 259, 60);
  EXPECT_NEAR(pairs / (taken * kTilePixels), 0.21, 0.04);
  check_every_loss(o);
}

TEST_P(SemanticVisitTile, EveryInstructionSet) {
  for_each_target([&] {
    TileOptions o;
    o.channels = 37;
    check_every_loss(o);
  });
}

/// Behind an opaque surface dL/dalpha is T (q - the blend behind), with T < 0.01. A total with other rounding than the
/// summed q would drown it. Here the error must be small beside the largest gradient *behind the surface*.
TEST_P(SemanticVisitTile, AlphaGradientsBehindAnOpaqueSurface) {
  for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
    for (const SemanticCoupling coupling :
         {SemanticCoupling::kBounded, SemanticCoupling::kPlain, SemanticCoupling::kOpacity}) {
      SCOPED_TRACE(testing::Message() << "blend " << int(blend) << ", coupling " << int(coupling));
      TileOptions o;
      o.opaque_front = true;
      o.gaussians = 30;
      o.alpha_max = 0.3;
      o.blend = blend;
      o.coupling = coupling;
      o.spread = blend == SemanticBlend::kProbabilities ? kAboveTheFloor : 2.0;
      HandMadeTile tile(o);
      const auto worst_behind = [&] {
        double largest = 0, worst = 0;
        for (size_t i = 2; i < o.gaussians; ++i) {
          largest = std::max(largest, std::abs(tile.want_alpha[i]));
          worst = std::max(worst, std::abs(static_cast<double>(tile.sums[i].coupling_one) - tile.want_alpha[i]));
        }
        EXPECT_GT(largest, 0.0);
        return worst / largest;
      };
      for (const BlockWeights& block : tile.tile.blocks) {
        for (const float t : block.transmittance) ASSERT_LT(t, 0.01f);
      }
      check_products(tile);
      EXPECT_LE(worst_behind(), exact() ? 1e-4 : 0.03);
    }
  }
}

TEST(SemanticVisit, ForcedBfloat16NeedsAmx) {
  CpuEngine engine(1);
  if (matrix_tiles_available()) {
    EXPECT_NO_THROW(engine.set_semantic_products(SemanticProducts::kBfloat16));
  } else {
    EXPECT_THROW(engine.set_semantic_products(SemanticProducts::kBfloat16), Error);
  }
}

/// Any number of threads, the same bits: sums of groups of tiles and of Gaussians that reach across them.
TEST_P(SemanticVisitTile, AnyNumberOfThreadsGivesTheSameBits) {
  RandomSceneOptions o;
  o.width = 150;
  o.height = 170;  // 110 tiles: groups of one tile; then 440: groups of four
  o.channels = 21;
  o.log_scale_max = -1;
  for (const int scale : {1, 2}) {
    o.width *= scale;
    o.height *= scale;
    std::vector<float> semantics, opacities;
    for (const int threads : {1, 2, 5}) {
      CpuEngine engine(threads);
      engine.set_semantic_products(GetParam());
      engine.load(make_model(o));
      engine.set_training_views({make_view(o)});
      engine.set_coupling_balance({2e-4, 1e-3});
      engine.step(make_request());
      GaussianModel m;
      engine.store(m);
      if (threads == 1) {
        semantics = m.semantics;
        opacities = m.opacity_logits;
      }
      EXPECT_EQ(m.semantics, semantics) << threads;
      EXPECT_EQ(m.opacity_logits, opacities) << threads;
    }
  }
}

}  // namespace
}  // namespace aligngs::cpu
