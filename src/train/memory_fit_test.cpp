#include "train/memory_fit.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace aligngs {
namespace {

uint64_t hundred_bytes(uint64_t n) { return 100 * n; }

TEST(MemoryFit, DenseStartGrowsByItsFactor) {
  MemoryBudget budget(1000000000);
  const GaussianCap cap = fit_gaussian_cap({make_preset(Preset::kDefault), 1000, true, 250000, 20000000, hundred_bytes}, budget);
  EXPECT_EQ(cap.gaussians, 1500u);
  EXPECT_TRUE(cap.warning.empty());
  EXPECT_EQ(budget.total(), 150000u);
}

TEST(MemoryFit, SparseStartGrowsToTheLimitOfDenseOnes) {
  MemoryBudget budget(1000000000);
  EXPECT_EQ(fit_gaussian_cap({make_preset(Preset::kDefault), 1000, false, 250000, 20000000, hundred_bytes}, budget).gaussians, 375000u);
}

TEST(MemoryFit, PaperGrowsToSixMillionOrWhatMemoryHolds) {
  MemoryBudget large(1000000000), small(1000000);
  EXPECT_EQ(fit_gaussian_cap({make_preset(Preset::kPaper), 1000, false, 250000, 20000000, hundred_bytes}, large).gaussians, 6000000u);
  const GaussianCap cap = fit_gaussian_cap({make_preset(Preset::kPaper), 1000, false, 250000, 20000000, hundred_bytes}, small);
  EXPECT_EQ(cap.gaussians, 10000u);
  EXPECT_FALSE(cap.warning.empty());
}

TEST(MemoryFit, PaperGrowsToHalfThePixelsAndLessInAShortRun) {
  TrainConfig config = make_preset(Preset::kPaper);
  MemoryBudget whole(1000000000), brief(1000000000);
  EXPECT_EQ(fit_gaussian_cap({config, 1000, false, 100000, 1536000, hundred_bytes}, whole).gaussians, 768000u);
  config.train.iterations = 700;
  EXPECT_EQ(fit_gaussian_cap({config, 1000, false, 100000, 1536000, hundred_bytes}, brief).gaussians, 76800u);
}

TEST(MemoryFit, StartThatDoesNotFitIsAResourceError) {
  MemoryBudget budget(50000);
  try {
    fit_gaussian_cap({make_preset(Preset::kDefault), 1000, true, 250000, 20000000, hundred_bytes}, budget);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
  }
}

TEST(MemoryFit, WithoutDensityControlTheStartIsTheCap) {
  TrainConfig config = make_preset(Preset::kPaper);
  config.densify.enabled = false;
  MemoryBudget budget(1000000000);
  EXPECT_EQ(fit_gaussian_cap({config, 1000, false, 250000, 20000000, hundred_bytes}, budget).gaussians, 1000u);
}

}  // namespace
}  // namespace aligngs
