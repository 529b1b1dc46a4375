#include "metrics/semantic_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace aligngs {
namespace {

TEST(ConfusionMatrix, HandComputedScores) {
  ConfusionMatrix matrix(3);
  // Class 0: 3 right, 1 taken for 1. Class 1: 2 right. Class 2 never in the truth.
  for (int i = 0; i < 3; ++i) matrix.add(0, 0);
  matrix.add(0, 1);
  for (int i = 0; i < 2; ++i) matrix.add(1, 1);
  const SemanticScores scores = matrix.scores();
  EXPECT_EQ(scores.classes, 2);
  EXPECT_NEAR(scores.iou[0], 3.0 / 4, 1e-12);
  EXPECT_NEAR(scores.iou[1], 2.0 / 3, 1e-12);
  EXPECT_TRUE(std::isnan(scores.iou[2]));
  EXPECT_NEAR(scores.miou, (3.0 / 4 + 2.0 / 3) / 2, 1e-12);
  EXPECT_NEAR(scores.accuracy, 5.0 / 6, 1e-12);
}

TEST(ConfusionMatrix, NoPredictionIsWrongAndNoTruthIsIgnored) {
  ConfusionMatrix matrix(2);
  matrix.add(0, 0);
  matrix.add(0, kNoLabel);  // wrong
  matrix.add(0, 77);        // no such class: wrong
  matrix.add(kNoLabel, 1);  // ignored, and no false positive of class 1
  const SemanticScores scores = matrix.scores();
  EXPECT_EQ(scores.samples, 3u);
  EXPECT_NEAR(scores.accuracy, 1.0 / 3, 1e-12);
  EXPECT_NEAR(scores.iou[0], 1.0 / 3, 1e-12);
}

TEST(ConfusionMatrix, RareClassesDoNotCount) {
  ConfusionMatrix matrix(2);
  for (int i = 0; i < 2000; ++i) matrix.add(0, 0);
  matrix.add(1, 0);  // 0.05 % of the pixels
  EXPECT_EQ(matrix.scores().classes, 1);
  EXPECT_EQ(matrix.scores(0).classes, 2);
}

/// 2000 pixels: class 0 has 1997 of them, 3 taken for class 1. Class 1 has 2, one of them taken for class 0 and both
/// too few to count. Class 2 has 1, found. Class 3 is not in the truth.
TEST(ConfusionMatrix, TwoRulesForWhichClassesAreInTheMean) {
  ConfusionMatrix matrix(4);
  for (int i = 0; i < 1994; ++i) matrix.add(0, 0);
  for (int i = 0; i < 3; ++i) matrix.add(0, 1);
  matrix.add(1, 1);
  matrix.add(1, 0);
  matrix.add(2, 2);
  const SemanticScores scores = matrix.scores(0.0011);
  EXPECT_EQ(scores.classes, 1);
  EXPECT_NEAR(scores.miou, 1994.0 / 1998, 1e-12);
  EXPECT_EQ(scores.present_classes, 3);
  EXPECT_NEAR(scores.present_miou, (1994.0 / 1998 + 1.0 / 5 + 1) / 3, 1e-12);
  EXPECT_TRUE(std::isnan(scores.iou[1]));
  EXPECT_NEAR(scores.present_iou[1], 1.0 / 5, 1e-12);
  EXPECT_EQ(scores.present_iou[2], 1);
  EXPECT_TRUE(std::isnan(scores.present_iou[3]));
}

TEST(ConfusionMatrix, NothingLabelledGivesNoNumber) {
  const SemanticScores scores = ConfusionMatrix(2).scores();
  EXPECT_TRUE(std::isnan(scores.miou));
  EXPECT_TRUE(std::isnan(scores.present_miou));
  EXPECT_TRUE(std::isnan(scores.accuracy));
}

TEST(ConfusionMatrix, BadInputIsRefused) {
  ConfusionMatrix matrix(2);
  EXPECT_THROW(matrix.add(2, 0), Error);
  EXPECT_THROW(matrix.add(Image<uint16_t>(2, 2, 1), Image<uint16_t>(3, 2, 1)), Error);
}

TEST(MeshLabels, MissingSurfaceCountsAsWrongInAllAndNotInCovered) {
  TriangleMesh truth, predicted;
  truth.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  truth.labels = {0, 0, 1, kNoLabel};
  predicted.vertices = {{0, 0, 0.03f}, {1, 0, 0.03f}, {2, 0, 0.5f}};
  predicted.labels = {0, 1, 1};
  ThreadPool pool(2);
  const MeshLabelScores scores = compare_mesh_labels(predicted, truth, 2, pool);
  EXPECT_NEAR(scores.coverage, 2.0 / 3, 1e-12);
  EXPECT_NEAR(scores.all.accuracy, 1.0 / 3, 1e-12);
  EXPECT_NEAR(scores.covered.accuracy, 1.0 / 2, 1e-12);
  EXPECT_EQ(scores.class_coverage, (std::vector<double>{1, 0}));
  predicted.labels.clear();
  EXPECT_THROW(compare_mesh_labels(predicted, truth, 2, pool), Error);
}

}  // namespace
}  // namespace aligngs
