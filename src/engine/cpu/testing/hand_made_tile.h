// A tile made by hand and the semantic visit to it, beside the formulas in double precision.
#pragma once

#include "engine/cpu/simd_targets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "core/half.h"
#include "core/random.h"
#include "engine/cpu/bf16_packing.h"
#include "engine/cpu/blend_backward.h"
#include "engine/cpu/semantic_rows.h"
#include "engine/cpu/semantic_visit.h"
#include "engine/cpu/testing/hand_made_weights.h"
#include "engine/cpu/testing/products.h"
#include "engine/cpu/tile_products.h"
#include "engine/formulas/semantic_loss.h"
#include "engine/formulas/teacher_sampling.h"
#include "engine/testing/request.h"
#include "engine/testing/scenes.h"
#include "scene/semantic_target.h"

namespace aligngs::cpu::testing_scene {

/// Beside the largest of the tile. bfloat16 keeps each term of a product within 2^-8 of itself, and the errors of many
/// terms partly cancel.
struct VisitTolerance {
  double loss, rows, coupling;
  double floor;  ///< distance from the floor, in units of it, beyond which the side of a blended probability is known
};
inline constexpr VisitTolerance kFloat32Tolerance{5e-6, 2e-5, 5e-5, 1e-5};
inline constexpr VisitTolerance kBfloat16Tolerance{1e-2, 1.2e-2, 2e-2, 1.0 / 128};

class HandMadeTile {
 public:
  explicit HandMadeTile(const TileOptions& o) : options(o) {
    Random random(5);
    RandomSceneOptions scene;
    scene.width = scene.height = kTileSize;
    scene.channels = o.channels;
    view = make_view(scene);
    if (!o.silent_corner) std::fill(view.data.semantics.confidence.begin(), view.data.semantics.confidence.end(), 0.9f);
    losses.semantic_blend = o.blend;
    losses.coupling = o.coupling;
    channels = static_cast<size_t>(o.channels);
    padded = padded_channels(o.channels);
    logits.assign(o.gaussians * channels, 0.0f);
    for (float& x : logits) x = static_cast<float>(o.spread * random.normal() + 3);  // not centred
    if (o.trained) train(random);
    make_tile_weights(o, random, tile);
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
  void expect_close(const VisitTolerance& tolerance) {
    floor_margin_ = tolerance.floor;
    row_slack_.assign(options.gaussians * channels, 0.0);
    at_floor = beside_floor = classes_seen = 0;
    const size_t n = options.gaussians;
    std::vector<double> features(logits.begin(), logits.end()), want(n * channels, 0.0), want_coupling, coupling_slack;
    if (options.blend == SemanticBlend::kProbabilities) {
      for (size_t i = 0; i < n; ++i) softmax(&features[i * channels], options.channels, &features[i * channels]);
    }
    double want_soft = 0, want_hard = 0;
    want_alpha.assign(n, 0.0);
    std::vector<float> got_coupling;
    for (int b = 0; b < kTileBlocks; ++b) {
      const BlockWeights& block = tile.blocks[b];
      std::vector<double> q(block.count * kBlockPixels, 0.0);
      q_slack_.assign(q.size(), 0.0);
      for (int i = 0; i < kBlockPixels; ++i) visit_pixel(block, i, features, want, q, want_soft, want_hard);
      for (size_t k = 0; k < q.size(); ++k) {  // elsewhere the Gaussian has no weight and nothing reads q
        const unsigned strips = block.strips[k / kBlockPixels];
        if (((strips >> (k % kBlockPixels / kStripPixels)) & 1u) == 0) continue;
        want_coupling.push_back(q[k]);
        coupling_slack.push_back(q_slack_[k]);
        got_coupling.push_back(coupling[b][k]);
      }
    }
    const double valid = static_cast<double>(cache.valid);
    EXPECT_NEAR(soft / valid, want_soft / valid, tolerance.loss);
    EXPECT_NEAR(hard / valid, want_hard / valid, tolerance.loss);
    if (options.channels == 1 && options.blend == SemanticBlend::kLogits) {
      for (const float g : row_gradients) EXPECT_NEAR(g, 0, 1e-6 / valid);  // one class: nothing to learn
      return;
    }
    const auto rows = difference_beyond(row_slack_, row_gradients, want);
    EXPECT_LE(rows.worst, tolerance.rows) << "row gradient " << rows.at << ", largest " << rows.scale;
    if (options.channels == 1 && options.coupling == SemanticCoupling::kBounded) {
      // One class is always right; what is left is rounding of weights beside 1 / A.
      for (const float q : got_coupling) EXPECT_NEAR(q, 0, 1e-2 / valid);
      return;
    }
    const auto alpha = difference_beyond(coupling_slack, got_coupling, want_coupling);
    EXPECT_LE(alpha.worst, tolerance.coupling) << "coupling " << alpha.at << ", largest " << alpha.scale;
  }

  TileOptions options;
  TrainingView view;
  LossSettings losses = color_and_class_losses();
  SemanticView cache;
  ClassCounts counts;
  size_t channels = 0, padded = 0;
  std::vector<float> logits;
  TileWeights tile;

  double soft = 0, hard = 0;
  AlignedArray<float> coupling[kTileBlocks];
  std::vector<float> row_gradients;
  AlignedArray<CoupledSplatGradient> sums;
  std::vector<double> want_alpha;  ///< [gaussians] sum over pixels of w (q - the blend behind)
  /// (Pixel, class) pairs of blended probabilities: those without a gradient, those whose side of the floor is not
  /// told, all.
  size_t at_floor = 0, beside_floor = 0, classes_seen = 0;

 private:
  /// The difference beyond what each entry may be off, relative to the largest wanted.
  static Difference difference_beyond(const std::vector<double>& slack, const std::vector<float>& got,
                                      const std::vector<double>& want) {
    Difference d;
    for (size_t i = 0; i < want.size(); ++i) {
      d.scale = std::max(d.scale, std::abs(want[i]));
      const double beyond = std::abs(static_cast<double>(got[i]) - want[i]) - slack[i];
      if (!(beyond <= d.worst)) d.worst = beyond, d.at = i;
    }
    d.worst = d.scale > 0 ? d.worst / d.scale : d.worst;
    return d;
  }

  /// Three classes share the tile. Every row has one of them ten nats above the others. Every pixel of the teacher has
  /// nine tenths of its mass on one.
  void train(Random& random) {
    constexpr size_t kShown[3] = {3, 40, 97};
    for (size_t i = 0; i < options.gaussians; ++i) logits[i * channels + kShown[random.below(3)]] += 10.0f;
    SemanticTarget& t = view.data.semantics;
    std::vector<double> p(channels);
    for (size_t pixel = 0; pixel < t.confidence.size(); ++pixel) {
      double sum = 0;
      for (double& x : p) sum += x = std::exp(2 * random.normal());
      for (double& x : p) x *= 0.1 / sum;
      p[kShown[pixel % static_cast<size_t>(t.width) * 3 / static_cast<size_t>(t.width)]] += 0.9;
      for (size_t c = 0; c < channels; ++c) {
        t.probabilities[pixel * channels + c] = float_to_half(static_cast<float>(p[c]));
      }
    }
    normalise_target(t);
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
    const SemanticWeights<double> weights{static_cast<double>(losses.weight[Loss::kSemanticSoft]) / valid,
                                          static_cast<double>(losses.weight[Loss::kSemanticHard]) / valid};
    const SemanticTerms<double> terms =
        probabilities
            ? semantic_loss_probabilities(blended.data(), alpha, teacher.data(), c_count, weights, g.data())
            : semantic_loss_logits(blended.data(), teacher.data(), c_count, weights, student.data(), g.data());
    want_soft += terms.soft;
    want_hard += terms.hard;
    const std::vector<double> jump = jumps_at_floor(blended, alpha, teacher, weights);
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
        if (!probabilities || jump[c] == 0) continue;
        row_slack_[block.entry[e] * channels + c] += w * jump[c];
        if (options.coupling != SemanticCoupling::kPlain) continue;
        q_slack_[e * kBlockPixels + i] += jump[c] * (row[c] + 1 / static_cast<double>(c_count));
      }
      q[e * kBlockPixels + i] = dot;
      want_alpha[block.entry[e]] += w * (dot - behind);
      const double a = static_cast<double>(block.alpha[e * kBlockPixels + i]);
      behind += a * (dot - behind);
    }
  }

  /// How far the gradient of each class may be off because its Q may be rounded to the other side of the floor.
  std::vector<double> jumps_at_floor(const std::vector<double>& blended, double alpha,
                                     const std::vector<double>& teacher, const SemanticWeights<double>& weights) {
    const int c_count = options.channels, top = arg_max(teacher.data(), c_count);
    const double floor = semantic_floor<double>(c_count), rest = (1 - alpha) / c_count;
    std::vector<double> jump(channels, 0.0);
    for (size_t c = 0; c < channels; ++c) {
      const double q = blended[c] + rest;
      ++classes_seen;
      at_floor += q <= floor ? 1 : 0;
      if (std::abs(q - floor) > floor_margin_ * floor) continue;
      ++beside_floor;
      jump[c] = (weights.soft * teacher[c] + (static_cast<int>(c) == top ? weights.hard : 0.0)) / floor;
    }
    return jump;
  }

  double floor_margin_ = 0;
  std::vector<double> row_slack_;  ///< [gaussians][channels]
  std::vector<double> q_slack_;    ///< [entries of the block at hand][64]
};

}  // namespace aligngs::cpu::testing_scene
