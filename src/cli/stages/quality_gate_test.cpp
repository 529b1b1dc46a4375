#include "cli/stages/quality_gate.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace aligngs {
namespace {

RunMetrics metrics_with_psnr(double psnr) {
  RunMetrics metrics;
  metrics.novel_views.emplace().psnr = psnr;
  return metrics;
}

ErrorKind failure_of(const RunMetrics& metrics, const std::string& condition) {
  try {
    require_at_least(metrics, least_values({condition}));
  } catch (const Error& error) {
    return error.kind();
  }
  ADD_FAILURE() << condition << " holds";
  return ErrorKind::kFailed;
}

TEST(QualityGate, AFigureAtTheLimitIsEnough) {
  EXPECT_NO_THROW(require_at_least(metrics_with_psnr(24), least_values({"psnr=24", "nvs.psnr=23.9"})));
}

TEST(QualityGate, ALowerFigureFails) { EXPECT_EQ(failure_of(metrics_with_psnr(23), "psnr=24"), ErrorKind::kBelow); }

TEST(QualityGate, AFigureThatWasNotMeasuredIsNoFigure) {
  EXPECT_EQ(failure_of(metrics_with_psnr(23), "fscore=0.1"), ErrorKind::kUsage);
  EXPECT_EQ(failure_of(metrics_with_psnr(23), "ssim=0.1"), ErrorKind::kUsage) << "NaN";
}

TEST(QualityGate, SaysWhichPartOfTheRunWasNotMeasured) {
  RunMetrics metrics;
  metrics.novel_views.emplace().views = 0;
  const std::pair<const char*, const char*> cases[] = {
      {"psnr=1", "no test view was measured"}, {"fscore=0", "no true mesh"}, {"miou=0", "no labels of test views"}};
  for (const auto& [condition, reason] : cases) {
    try {
      require_at_least(metrics, least_values({condition}));
      ADD_FAILURE() << condition << " holds";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  }
}

TEST(QualityGate, ClassesOfTheLabelsAreFigures) {
  RunMetrics metrics;
  metrics.labels.classes = {{"wall", {}, {}}};
  metrics.semantics.emplace().iou = {0.5};
  EXPECT_EQ(failure_of(metrics, "semantics.iou.wall=0.6"), ErrorKind::kBelow);
  EXPECT_EQ(failure_of(metrics, "semantics.iou.floor=0.6"), ErrorKind::kUsage);
}

}  // namespace
}  // namespace aligngs
