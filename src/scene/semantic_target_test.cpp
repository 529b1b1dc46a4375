#include "scene/semantic_target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/half.h"
#include "core/random.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

/// One pixel with the given class values.
SemanticTarget pixel(std::vector<float> values, SemanticKind kind, double gamma = 1) {
  return semantic_target(values.data(), static_cast<int>(values.size()), 1, 1, {kind, gamma});
}

float probability(const SemanticTarget& target, int c) { return half_to_float(target.probabilities[c]); }

TEST(SemanticTarget, LogitsGoThroughSoftmax) {
  const SemanticTarget t = pixel({1, 0, 0}, SemanticKind::kLogits);
  EXPECT_NEAR(probability(t, 0), std::exp(1.0) / (std::exp(1.0) + 2), 1e-3);
  EXPECT_EQ(t.confidence[0], 1);
}

TEST(SemanticTarget, SoftmaxOfOneScoreAmong150IsAlmostUniform) {
  std::vector<float> scores(150, 0.0f);
  scores[7] = 1;
  EXPECT_NEAR(probability(pixel(scores, SemanticKind::kLogits), 7), 0.017917, 1e-5);
}

TEST(SemanticTarget, HugeLogitsDoNotOverflow) {
  const SemanticTarget t = pixel({3e38f, -3e38f, 0}, SemanticKind::kLogits);
  EXPECT_EQ(probability(t, 0), 1);
  EXPECT_EQ(probability(t, 1), 0);
}

TEST(SemanticTarget, ScoresAreDividedByTheirSumAndNegativeOnesDropped) {
  const SemanticTarget t = pixel({0.6f, 0.2f, -0.5f}, SemanticKind::kScores);
  EXPECT_NEAR(probability(t, 0), 0.75, 1e-3);
  EXPECT_EQ(probability(t, 2), 0);
  EXPECT_EQ(t.confidence[0], 1);
}

TEST(SemanticTarget, GammaSharpensScores) {
  EXPECT_NEAR(probability(pixel({0.6f, 0.2f}, SemanticKind::kScores, 2), 0), 0.9, 1e-3);
}

TEST(SemanticTarget, ScoresWithASmallSumSayNothing) {
  EXPECT_EQ(pixel({0.1f, 0.15f}, SemanticKind::kScores).confidence[0], 0);
  EXPECT_EQ(pixel({0.2f, 0.15f}, SemanticKind::kScores).confidence[0], 1);
}

TEST(SemanticTarget, WhatASmallSumIsCanBeChosen) {
  const float scores[2] = {0.2f, 0.15f};
  SemanticConversion conversion;
  conversion.kind = SemanticKind::kScores;
  conversion.least_score_sum = 0.5;
  EXPECT_EQ(semantic_target(scores, 2, 1, 1, conversion).confidence[0], 0);
}

TEST(SemanticTarget, KeepsWhatTheScoresSummedTo) {
  EXPECT_FLOAT_EQ(pixel({0.2f, 0.15f, -1}, SemanticKind::kScores).score_sum[0], 0.35f);
  EXPECT_EQ(pixel({0.9f, 0.8f}, SemanticKind::kScores).score_sum[0], 1);
  EXPECT_EQ(pixel({0, 0}, SemanticKind::kScores).score_sum[0], 0);
  EXPECT_EQ(pixel({2, 1}, SemanticKind::kLogits).score_sum[0], 1);
  EXPECT_EQ(pixel({0.2f, 0.6f}, SemanticKind::kProbabilities).score_sum[0], 1);
}

TEST(SemanticTarget, ProbabilitiesStayAsTheyAre) {
  const SemanticTarget t = pixel({0.25f, 0.75f}, SemanticKind::kProbabilities, 2);
  EXPECT_NEAR(probability(t, 0), 0.25, 1e-3);
}

/// 147 equal numbers are rounded the same way, so that their errors add up.
TEST(SemanticTarget, ScaledProbabilitiesSumToOne) {
  std::vector<float> scores(150, 0.0f);
  for (const size_t i : {2, 9, 100}) scores[i] = 1;
  const SemanticTarget t = pixel(scores, SemanticKind::kLogits);
  double stored = 0, scaled = 0;
  for (int c = 0; c < 150; ++c) {
    stored += static_cast<double>(probability(t, c));
    scaled += static_cast<double>(t.scale[0] * probability(t, c));
  }
  EXPECT_GT(std::abs(stored - 1), 1e-4);
  EXPECT_NEAR(scaled, 1, 1e-6);
}

TEST(SemanticTarget, NumbersWithoutASumKeepTheirScale) {
  SemanticTarget t;
  t.channels = 2;
  t.width = 1;
  t.height = 1;
  for (const float value : {0.0f, std::numeric_limits<float>::infinity()}) {
    t.probabilities = {float_to_half(value), float_to_half(0.0f)};
    normalise_target(t);
    EXPECT_EQ(t.scale[0], 1);
  }
}

TEST(SemanticTarget, PixelsWithoutAnyInformationAreUniformAndUnknown) {
  for (float value : {0.0f, std::numeric_limits<float>::quiet_NaN()}) {
    const SemanticTarget t = pixel({value, value}, SemanticKind::kScores);
    EXPECT_EQ(probability(t, 1), 0.5);
    EXPECT_EQ(t.confidence[0], 0);
  }
  EXPECT_EQ(pixel({std::numeric_limits<float>::infinity(), 0}, SemanticKind::kLogits).confidence[0], 0);
}

TEST(SemanticTarget, PlanesBecomeInterleavedPixels) {
  const float planes[] = {1, 0, 0, 0, 0, 1,   // class 0 of a 3 x 2 map
                          0, 1, 1, 1, 1, 0};  // class 1
  const Image<uint16_t> labels =
      target_labels(semantic_target(planes, 2, 3, 2, {SemanticKind::kProbabilities, 1}), 3, 2);
  EXPECT_EQ(labels.data, (std::vector<uint16_t>{0, 1, 1, 1, 1, 0}));
}

TEST(TargetLabels, UpsamplingFollowsTheHalfPixelRule) {
  const float planes[] = {1, 0, 0, 1};  // two pixels: class 0, class 1
  const SemanticTarget t = semantic_target(planes, 2, 2, 1, {SemanticKind::kProbabilities, 1});
  EXPECT_EQ(target_labels(t, 8, 1).data, (std::vector<uint16_t>{0, 0, 0, 0, 1, 1, 1, 1}));
}

// The oracle: each pixel's classes are blended and compared one by one.
TEST(TargetLabels, EveryPixelHasTheFirstOfItsLargestBlendedClasses) {
  for (const int channels : {1, 2, 7, 8, 9, 19, 150}) {
    constexpr int kSmall = 5, kWide = 12;
    Random random(static_cast<uint64_t>(channels));
    std::vector<float> values(static_cast<size_t>(channels * kSmall * kSmall));
    for (float& v : values) v = static_cast<float>(std::floor(random.uniform() * 4));  // ties are common
    const SemanticTarget t = semantic_target(values.data(), channels, kSmall, kSmall, {SemanticKind::kLogits, 1});
    const Image<uint16_t> labels = target_labels(t, kWide, kWide);
    for (int y = 0; y < kWide; ++y) {
      for (int x = 0; x < kWide; ++x) {
        const auto at = [](int i) { return std::clamp((i + 0.5) * kSmall / kWide - 0.5, 0.0, kSmall - 1.0); };
        const int x0 = static_cast<int>(at(x)), y0 = static_cast<int>(at(y));
        const int x1 = std::min(x0 + 1, kSmall - 1), y1 = std::min(y0 + 1, kSmall - 1);
        const float wx = static_cast<float>(at(x) - x0), wy = static_cast<float>(at(y) - y0);
        const auto value = [&](int px, int py, int c) {
          const size_t p = static_cast<size_t>(py * kSmall + px);
          return t.scale[p] *
                 half_to_float(t.probabilities[p * static_cast<size_t>(channels) + static_cast<size_t>(c)]);
        };
        int best = 0;
        float most = -1;
        for (int c = 0; c < channels; ++c) {
          const float left = value(x0, y0, c) * (1 - wy) + value(x0, y1, c) * wy,
                      right = value(x1, y0, c) * (1 - wy) + value(x1, y1, c) * wy;
          const float blended = left * (1 - wx) + right * wx;
          if (blended > most) best = c;
          most = std::max(most, blended);
        }
        ASSERT_EQ(labels.at(x, y), best) << channels << " classes, " << x << ", " << y;
      }
    }
  }
}

TEST(TargetLabels, UnknownPixelsHaveNoLabel) {
  const float planes[] = {0.9f, 0.01f, 0, 0.01f};
  const SemanticTarget t = semantic_target(planes, 2, 2, 1, {SemanticKind::kScores, 1});
  EXPECT_EQ(target_labels(t, 2, 1).data, (std::vector<uint16_t>{0, kNoLabel}));
  EXPECT_EQ(target_labels(t, 4, 1).data, (std::vector<uint16_t>{0, 0, kNoLabel, kNoLabel}));
}

TEST(TargetLabels, AnEmptyTargetHasNoLabels) { EXPECT_EQ(target_labels({}, 1, 1).data[0], kNoLabel); }

}  // namespace
}  // namespace aligngs
