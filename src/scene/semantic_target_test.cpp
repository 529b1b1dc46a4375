#include "scene/semantic_target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/half.h"
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

TEST(TargetLabels, UnknownPixelsHaveNoLabel) {
  const float planes[] = {0.9f, 0.01f, 0, 0.01f};
  const SemanticTarget t = semantic_target(planes, 2, 2, 1, {SemanticKind::kScores, 1});
  EXPECT_EQ(target_labels(t, 2, 1).data, (std::vector<uint16_t>{0, kNoLabel}));
  EXPECT_EQ(target_labels(t, 4, 1).data, (std::vector<uint16_t>{0, 0, kNoLabel, kNoLabel}));
}

TEST(TargetLabels, AnEmptyTargetHasNoLabels) { EXPECT_EQ(target_labels({}, 1, 1).data[0], kNoLabel); }

}  // namespace
}  // namespace aligngs
