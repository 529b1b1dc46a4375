// The semantic visit to one tile against the formulas in double precision: every way to form the products, on tiles
// made by hand.
#include "engine/cpu/semantic_visit.h"

#include "engine/cpu/simd_targets.h"

#include <gtest/gtest.h>
#include <memory>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "core/error.h"
#include "core/half.h"
#include "core/random.h"
#include "engine/cpu/bf16_packing.h"
#include "engine/cpu/blend_backward.h"
#include "engine/cpu/matrix_tiles.h"
#include "engine/cpu/semantic_rows.h"
#include "engine/cpu/test_scenes.h"
#include "engine/cpu/tile_products.h"
#include "engine/formulas/semantic_loss.h"
#include "engine/formulas/teacher_sampling.h"

namespace aligngs::cpu {
namespace {

/// What the four blocks of the tile blend; a Gaussian takes part in some of them.
struct TileOptions {
  size_t gaussians = 60;
  int channels = 150;
  double reach = 0.5;      ///< share of the blocks, and of a block's strips, that a Gaussian reaches
  double alpha_min = 0.1, alpha_max = 0.6;
  double spread = 2;       ///< standard deviation of the logits
  bool opaque_front = false;  ///< two Gaussians of alpha 0.95 before all others: T < 0.01 behind them
  bool silent_corner = false; ///< the teacher says nothing in part of the tile
  SemanticBlend blend = SemanticBlend::kProbabilities;
  SemanticCoupling coupling = SemanticCoupling::kBounded;
};

class HandMadeTile {
 public:
  explicit HandMadeTile(const TileOptions& o) : options(o) {
    Random random(5);
    testing_scene::SceneOptions scene;
    scene.width = scene.height = kTileSize;
    scene.channels = o.channels;
    view = testing_scene::make_view(scene);
    if (!o.silent_corner) std::fill(view.data.semantics.confidence.begin(), view.data.semantics.confidence.end(), 0.9f);
    losses.semantic_blend = o.blend;
    losses.coupling = o.coupling;
    channels = static_cast<size_t>(o.channels);
    padded = padded_channels(o.channels);
    logits.assign(o.gaussians * channels, 0.0f);
    for (float& x : logits) x = static_cast<float>(o.spread * random.normal() + 3);  // not centred
    make_weights(random);
    ThreadPool pool(1);
    prepare_semantic_view(view, o.channels, pool, cache);
    counts = make_class_counts(o.channels, 0);
  }

  void visit(SemanticProducts products) {
    const size_t n = options.gaussians, depth = padded_depth(padded);
    AlignedArray<float> features(n * padded);
    AlignedArray<uint16_t> rounded(n * depth);
    std::vector<uint32_t> rank(n);
    for (size_t i = 0; i < n; ++i) {
      rank[i] = static_cast<uint32_t>(i);
      float* row = features.data() + i * padded;
      const bool probabilities = options.blend == SemanticBlend::kProbabilities;
      if (probabilities) {
        softmax_row(&logits[i * channels], channels, padded, 0, row);
      } else {
        copy_row(&logits[i * channels], channels, padded, row);
      }
      round_row(row, channels, padded, depth, probabilities ? 0.0f : row_mean(row, channels, padded),
                rounded.data() + i * depth);
    }
    SemanticPass pass;
    pass.step = {&view, &cache, &losses, &counts, options.channels, padded, true};
    pass.rank = rank.data();
    pass.features = features.data();
    pass.rounded = products == SemanticProducts::kBfloat16 ? rounded.data() : nullptr;
    GroupSums own;
    own.index.resize(n);
    TileRows rows(own, padded, n);
    SemanticScratch scratch;
    SemanticVisit semantic(pass, tile, rows, scratch);
    soft = hard = 0;
    sums.resize(n);
    BackwardOptions backward;
    for (int b = 0; b < kTileBlocks; ++b) {
      const float* q = semantic.visit_block(b);
      soft += scratch.block.soft;
      hard += scratch.block.hard;
      coupling[b].assign(tile.blocks[b].count * kBlockPixels, 0.0f);
      for (size_t e = 0; q != nullptr && e < tile.blocks[b].count; ++e) {
        const size_t row = semantic.coupling_rows() != nullptr ? semantic.coupling_rows()[tile.blocks[b].entry[e]] : e;
        std::copy_n(q + row * kBlockPixels, kBlockPixels, coupling[b].data() + e * kBlockPixels);
      }
      backward.coupling[b] = q;
    }
    backward.coupling_rows = semantic.coupling_rows();
    auto none = std::make_unique<TileGradients>();
    std::memset(static_cast<void*>(none.get()), 0, sizeof *none);
    blend_tile_backward(tile, ProjectionCamera<float>{}, RasterSettings{}, *none, backward, {sums.data(), 0, 0});
    semantic.finish();
    row_gradients.assign(n * channels, 0.0f);
    for (size_t r = 0; r < own.count; ++r) {
      std::copy_n(own.rows.data() + r * padded, channels, row_gradients.begin() + own.gaussians[r] * channels);
    }
  }

  /// The same in double precision, pixel by pixel.
  void expect_close(double loss_tolerance, double row_tolerance, double coupling_tolerance) {
    const size_t n = options.gaussians;
    std::vector<double> features(logits.begin(), logits.end()), want(n * channels, 0.0), want_coupling;
    if (options.blend == SemanticBlend::kProbabilities) {
      for (size_t i = 0; i < n; ++i) softmax(&features[i * channels], options.channels, &features[i * channels]);
    }
    double want_soft = 0, want_hard = 0;
    want_alpha.assign(n, 0.0);
    std::vector<float> got_coupling;
    for (int b = 0; b < kTileBlocks; ++b) {
      const BlockWeights& block = tile.blocks[b];
      std::vector<double> q(block.count * kBlockPixels, 0.0);
      for (int i = 0; i < kBlockPixels; ++i) visit_pixel(block, i, features, want, q, want_soft, want_hard);
      for (size_t k = 0; k < q.size(); ++k) {  // elsewhere the Gaussian has no weight and nothing reads q
        const unsigned strips = block.strips[k / kBlockPixels];
        if (((strips >> (k % kBlockPixels / kStripPixels)) & 1u) == 0) continue;
        want_coupling.push_back(q[k]);
        got_coupling.push_back(coupling[b][k]);
      }
    }
    const double valid = static_cast<double>(cache.valid);
    EXPECT_NEAR(soft / valid, want_soft / valid, loss_tolerance);
    EXPECT_NEAR(hard / valid, want_hard / valid, loss_tolerance);
    if (options.channels == 1 && options.blend == SemanticBlend::kLogits) {
      for (const float g : row_gradients) EXPECT_NEAR(g, 0, 1e-6 / valid);  // one class: nothing to learn
      return;
    }
    const auto rows = testing_scene::difference(row_gradients, want);
    EXPECT_LE(rows.worst, row_tolerance) << "row gradient " << rows.at << ", largest " << rows.scale;
    if (options.channels == 1 && options.coupling == SemanticCoupling::kBounded) {
      // One class is always right; what is left is rounding of weights beside 1 / A.
      for (const float q : got_coupling) EXPECT_NEAR(q, 0, 1e-2 / valid);
      return;
    }
    const auto alpha = testing_scene::difference(got_coupling, want_coupling);
    EXPECT_LE(alpha.worst, coupling_tolerance) << "coupling " << alpha.at << ", largest " << alpha.scale;
  }

  TileOptions options;
  TrainingView view;
  LossSettings losses;
  SemanticView cache;
  ClassCounts counts;
  size_t channels = 0, padded = 0;
  std::vector<float> logits;
  TileWeights tile;

  double soft = 0, hard = 0;
  AlignedArray<float> coupling[kTileBlocks];
  std::vector<float> row_gradients;
  AlignedArray<SplatGradient> sums;
  std::vector<double> want_alpha;  ///< [gaussians] sum over pixels of w (q - what stands behind)

 private:
  void make_weights(Random& random) {
    const size_t n = options.gaussians;
    tile.count = n;
    tile.splats.resize(n);
    tile.rows.resize(n);
    for (size_t i = 0; i < n; ++i) {
      tile.splats[i] = Splat{};
      tile.splats[i].slot_origin = static_cast<int64_t>(i);
      tile.rows[i] = static_cast<uint32_t>(i);
    }
    for (int b = 0; b < kTileBlocks; ++b) {
      BlockWeights& block = tile.blocks[b];
      block.x = (b & 1) * kBlockSize;
      block.y = (b >> 1) * kBlockSize;
      block.count = 0;
      block.entry.resize(n);
      block.alpha.resize(n * kBlockPixels);
      block.weight.resize(n * kBlockPixels);
      block.strips.resize(n);
      for (float& t : block.transmittance) t = 1;
      for (size_t i = 0; i < n; ++i) {
        const bool front = options.opaque_front && i < 2;
        if (!front && n > 1 && !random.chance(options.reach)) continue;
        add_entry(random, static_cast<uint32_t>(i), front, block);
      }
    }
  }

  void add_entry(Random& random, uint32_t gaussian, bool front, BlockWeights& block) {
    const size_t first = block.count * kBlockPixels;
    uint8_t strips = 0;
    for (int strip = 0; strip < kBlockPixels / kStripPixels; ++strip) {
      const bool here = front || options.gaussians == 1 || random.chance(options.reach);
      for (int k = 0; k < kStripPixels; ++k) {
        const size_t i = static_cast<size_t>(strip * kStripPixels + k);
        const double alpha = front ? 0.95 : here ? random.uniform(options.alpha_min, options.alpha_max) : 0.0;
        const float t = block.transmittance[i], next = t * (1 - static_cast<float>(alpha));
        const bool taken = here && next >= 1e-4f;
        block.alpha[first + i] = taken ? static_cast<float>(alpha) : 0.0f;
        block.weight[first + i] = taken ? static_cast<float>(alpha) * t : 0.0f;
        if (taken) block.transmittance[i] = next;
        if (taken) strips = static_cast<uint8_t>(strips | (1u << strip));
      }
    }
    block.entry[block.count] = gaussian;
    block.strips[block.count] = strips;
    block.count += strips != 0 ? 1 : 0;
  }

  void visit_pixel(const BlockWeights& block, int i, const std::vector<double>& features, std::vector<double>& want,
                   std::vector<double>& q, double& want_soft, double& want_hard) {
    const int x = block.x + i % kBlockSize, y = block.y + i / kBlockSize, c_count = options.channels;
    const TeacherTaps taps = teacher_taps(view.data.semantics, x, y, kTileSize, kTileSize);
    if (!semantic_pixel_valid(view.data, taps, x, y)) return;
    std::vector<float> sampled(channels);
    sample_teacher(view.data.semantics, taps, sampled.data());
    const std::vector<double> teacher(sampled.begin(), sampled.end());
    std::vector<double> blended(channels, 0.0), g(channels), h(channels), student(channels);
    for (size_t e = 0; e < block.count; ++e) {
      const double w = static_cast<double>(block.weight[e * kBlockPixels + i]);
      for (size_t c = 0; c < channels; ++c) blended[c] += w * features[block.entry[e] * channels + c];
    }
    const bool probabilities = options.blend == SemanticBlend::kProbabilities;
    const double valid = static_cast<double>(cache.valid), alpha = 1.0 - static_cast<double>(block.transmittance[i]);
    const SemanticWeights<double> weights{static_cast<double>(losses.semantic_soft_weight) / valid,
                                          static_cast<double>(losses.semantic_hard_weight) / valid};
    const SemanticTerms<double> terms =
        probabilities
            ? semantic_loss_probabilities(blended.data(), alpha, teacher.data(), c_count, weights, g.data())
            : semantic_loss_logits(blended.data(), teacher.data(), c_count, weights, student.data(), g.data());
    want_soft += terms.soft;
    want_hard += terms.hard;
    double offset = 0;
    h = g;
    if (options.coupling == SemanticCoupling::kPlain) {
      offset = plain_coupling_offset(probabilities, g.data(), c_count);
    } else {
      const double omega = static_cast<double>(view.semantic_weight.at(x, y)) / valid;
      if (options.coupling == SemanticCoupling::kOpacity) {
        std::fill(h.begin(), h.end(), 0.0);
        offset = omega;
      } else if (probabilities) {
        bounded_coupling_probabilities(blended.data(), alpha, teacher.data(), c_count, omega, h.data());
      } else {
        bounded_coupling_logits(student.data(), alpha, teacher.data(), c_count, omega, h.data());
      }
    }
    double behind = 0;
    for (size_t e = block.count; e-- > 0;) {
      const double* row = &features[block.entry[e] * channels];
      const double w = static_cast<double>(block.weight[e * kBlockPixels + i]);
      double dot = -offset;
      for (size_t c = 0; c < channels; ++c) {
        dot += h[c] * row[c];
        want[block.entry[e] * channels + c] += w * g[c];
      }
      q[e * kBlockPixels + i] = dot;
      want_alpha[block.entry[e]] += w * (dot - behind);
      const double a = static_cast<double>(block.alpha[e * kBlockPixels + i]);
      behind += a * (dot - behind);
    }
  }
};

/// Beside the largest of the tile. bfloat16 keeps each term of a product within 2^-8 of itself, and the errors of many
/// terms partly cancel.
struct VisitTolerance {
  double loss, rows, coupling;
};
constexpr VisitTolerance kFloat32Tolerance{5e-6, 2e-5, 5e-5};
constexpr VisitTolerance kBfloat16{1e-2, 1.2e-2, 2e-2};

/// The gradient -t / Q of blended probabilities jumps to 0 at the floor of Q, and a Q beside the floor may be rounded
/// to its other side. With logits this close together every Q stays above.
constexpr double kAboveTheFloor = 0.5;

void check_products(SemanticProducts products, HandMadeTile& tile) {
  const VisitTolerance t = products == SemanticProducts::kFloat32 ? kFloat32Tolerance : kBfloat16;
  tile.visit(products);
  tile.expect_close(t.loss, t.rows, t.coupling);
}

void check(const TileOptions& o) {
  SCOPED_TRACE(testing::Message() << o.gaussians << " Gaussians, " << o.channels << " classes, blend " << int(o.blend)
                                  << ", coupling " << int(o.coupling));
  HandMadeTile tile(o);
  check_products(SemanticProducts::kFloat32, tile);
  if (!matrix_tiles_available()) return;
  SCOPED_TRACE("bfloat16 products");
  TileOptions flat = o;
  if (o.blend == SemanticBlend::kProbabilities) flat.spread = kAboveTheFloor;
  HandMadeTile rounded(flat);
  check_products(SemanticProducts::kBfloat16, rounded);
}

void check_every_loss(TileOptions o) {
  for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
    for (const SemanticCoupling coupling :
           {SemanticCoupling::kBounded, SemanticCoupling::kPlain, SemanticCoupling::kOpacity}) {
      o.blend = blend;
      o.coupling = coupling;
      check(o);
    }
  }
}

TEST(SemanticVisit, EveryNumberOfClasses) {
  for (const int channels : {1, 2, 7, 16, 17, 33, 40, 150, 151}) {
    TileOptions o;
    o.channels = channels;
    check_every_loss(o);
  }
}

TEST(SemanticVisit, NoGaussianAndOne) {
  for (const size_t n : {size_t(0), size_t(1)}) {
    TileOptions o;
    o.gaussians = n;
    check_every_loss(o);
  }
}

TEST(SemanticVisit, GroupsOfEverySize) {
  for (const size_t n : {2, 31, 32, 33, 64, 65, 129}) {
    TileOptions o;
    o.gaussians = n;
    o.channels = 20;
    o.alpha_max = 0.15;
    check_every_loss(o);
  }
}

TEST(SemanticVisit, TenThousandGaussiansInATile) {
  TileOptions o;
  o.gaussians = 10000;
  o.channels = 31;
  o.reach = 0.2;
  o.alpha_min = 1.0 / 255;
  o.alpha_max = 1.0 / 128;
  check_every_loss(o);
}

TEST(SemanticVisit, AlphaAtItsThreshold) {
  TileOptions o;
  o.alpha_min = o.alpha_max = 1.0 / 255;
  o.gaussians = 400;
  o.channels = 40;
  check_every_loss(o);
}

TEST(SemanticVisit, TeacherThatIsSilentInPlaces) {
  TileOptions o;
  o.silent_corner = true;
  o.channels = 7;
  check_every_loss(o);
}

TEST(SemanticVisit, EveryInstructionSet) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    SCOPED_TRACE(hwy::TargetName(target));
    TileOptions o;
    o.channels = 37;
    check_every_loss(o);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

/// Behind an opaque surface dL/dalpha is T (q - what stands behind), with T < 0.01: a total of other rounding than the
/// q that are summed would drown it. Here the error must be small beside the largest gradient *behind the surface*.
TEST(SemanticVisit, AlphaGradientsBehindAnOpaqueSurface) {
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
      check_products(SemanticProducts::kFloat32, tile);
      EXPECT_LE(worst_behind(), 1e-4);
      if (!matrix_tiles_available()) continue;
      check_products(SemanticProducts::kBfloat16, tile);
      EXPECT_LE(worst_behind(), 0.03);
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

/// Both ways, any number of threads, the same bits: sums of groups of tiles and of Gaussians that reach across them.
TEST(SemanticVisit, AnyNumberOfThreadsGivesTheSameBits) {
  testing_scene::SceneOptions o;
  o.width = 150;
  o.height = 170;  // 110 tiles: groups of one tile; then 440: groups of four
  o.channels = 21;
  o.log_scale_max = -1;
  for (const int scale : {1, 2}) {
    o.width *= scale;
    o.height *= scale;
    for (const SemanticProducts products : {SemanticProducts::kFloat32, SemanticProducts::kAutomatic}) {
      std::vector<float> semantics, opacities;
      for (const int threads : {1, 2, 5}) {
        CpuEngine engine(threads);
        engine.set_semantic_products(products);
        engine.load(testing_scene::make_model(o));
        engine.set_training_views({testing_scene::make_view(o)});
        engine.set_coupling_balance({2e-4, 1e-3});
        engine.step(testing_scene::make_request());
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
}

}  // namespace
}  // namespace aligngs::cpu
