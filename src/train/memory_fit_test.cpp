#include "train/memory_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/log.h"
#include "train/testing/fake_engine.h"

namespace aligngs {
namespace {

using test_train::FakeEngine;

uint64_t hundred_bytes(uint64_t n) { return 100 * n; }

GaussianCap fit_host(const CapInputs& in, MemoryBudget& budget) {
  return fit_gaussian_cap(in, {{budget, "workspace", hundred_bytes}});
}

TEST(MemoryFit, DenseStartGrowsByItsFactor) {
  MemoryBudget budget(1000000000);
  const GaussianCap cap = fit_host({make_preset(Preset::kDefault), 1000, true, 250000, 20000000}, budget);
  EXPECT_EQ(cap.gaussians, 2500u);
  EXPECT_TRUE(cap.warning.empty());
  EXPECT_EQ(budget.total(), 250000u);
}

TEST(MemoryFit, SparseStartGrowsToTheLimitOfDenseOnes) {
  MemoryBudget budget(1000000000);
  EXPECT_EQ(fit_host({make_preset(Preset::kDefault), 1000, false, 250000, 20000000}, budget).gaussians, 625000u);
}

TEST(MemoryFit, PaperGrowsToSixMillionOrWhatMemoryHolds) {
  MemoryBudget large(1000000000), small(1000000);
  EXPECT_EQ(fit_host({make_preset(Preset::kPaper), 1000, false, 250000, 20000000}, large).gaussians, 6000000u);
  const GaussianCap cap = fit_host({make_preset(Preset::kPaper), 1000, false, 250000, 20000000}, small);
  EXPECT_EQ(cap.gaussians, 10000u);
  EXPECT_THAT(cap.warning, testing::StartsWith("memory holds 10000 Gaussians"));
}

TEST(MemoryFit, PaperGrowsToHalfThePixelsAndLessInAShortRun) {
  TrainConfig config = make_preset(Preset::kPaper);
  MemoryBudget whole(1000000000), brief(1000000000);
  EXPECT_EQ(fit_host({config, 1000, false, 100000, 1536000}, whole).gaussians, 768000u);
  config.train.iterations = 700;
  EXPECT_EQ(fit_host({config, 1000, false, 100000, 1536000}, brief).gaussians, 76800u);
}

TEST(MemoryFit, StartThatDoesNotFitIsAResourceError) {
  MemoryBudget budget(50000);
  try {
    fit_host({make_preset(Preset::kDefault), 1000, true, 250000, 20000000}, budget);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
  }
}

TEST(MemoryFit, WithoutDensityControlTheStartIsTheCap) {
  TrainConfig config = make_preset(Preset::kPaper);
  config.densify.enabled = false;
  MemoryBudget budget(1000000000);
  EXPECT_EQ(fit_host({config, 1000, false, 250000, 20000000}, budget).gaussians, 1000u);
}

TEST(MemoryFit, TheSmallestMemoryDecides) {
  const TrainConfig config = make_preset(Preset::kPaper);
  const CapInputs in{config, 1000, false, 250000, 20000000};
  MemoryBudget host(1000000), device(10000000);
  device.add("training views", 4000000);
  const auto thousand_bytes = [](uint64_t n) { return 1000 * n; };
  const GaussianCap cap =
      fit_gaussian_cap(in, {{host, "copies", hundred_bytes}, {device, "workspace", thousand_bytes, "cuda:7"}});
  EXPECT_EQ(cap.gaussians, 6000u);
  EXPECT_THAT(cap.warning, testing::StartsWith("the memory of cuda:7 holds 6000 Gaussians"));
  EXPECT_EQ(host.total(), 600000u);
  EXPECT_EQ(device.total(), 10000000u);
}

/// A preset that allows millions, classes 3, views that take 1000 bytes of the engine's memory.
class EngineMemoryFit : public testing::Test {
 protected:
  void SetUp() override { set_log_level(LogLevel::kSilent); }
  void TearDown() override { set_log_level(LogLevel::kInfo); }
  GaussianCap fit(const OwnMemory& memory, MemoryBudget& host) {
    engine_.memory = memory;
    return fit_to_engine({config_, 1000, false, 250000, 20000000}, {engine_, views_, 3, 1200}, host);
  }

  FakeEngine engine_;
  std::vector<TrainingView> views_;
  const TrainConfig config_ = make_preset(Preset::kPaper);
};

TEST_F(EngineMemoryFit, OwnMemoryLimitsGrowthBesideItsViews) {
  MemoryBudget host(uint64_t(1) << 40);
  const GaussianCap cap = fit({1000 + FakeEngine::bytes(5000, 3), 1000, 0}, host);
  EXPECT_EQ(cap.gaussians, 5000u);
  EXPECT_THAT(cap.warning, testing::HasSubstr("the memory of fake"));
  EXPECT_EQ(host.total(), FakeEngine::bytes(5000, 3) / 2) << "the host only keeps copies";
}

TEST_F(EngineMemoryFit, FewerChannelsThanClassesLeaveRoomForMoreGaussians) {
  MemoryBudget host(uint64_t(1) << 40);
  EXPECT_EQ(fit({1000 + FakeEngine::bytes(5000, 2), 1000, 2}, host).gaussians, 5000u);
}

TEST_F(EngineMemoryFit, TheHostStillLimitsWhatItCopies) {
  MemoryBudget host(FakeEngine::bytes(2000, 3) / 2);
  const GaussianCap cap = fit({uint64_t(1) << 40, 1000, 0}, host);
  EXPECT_EQ(cap.gaussians, 2000u);
  EXPECT_THAT(cap.warning, testing::StartsWith("memory holds"));
}

TEST_F(EngineMemoryFit, ARoomThatIsClosedInTheEndHasRoomKeptForThat) {
  TrainConfig config = config_;
  config.train.closed_room = true;
  MemoryBudget host(FakeEngine::bytes(8000, 3)), unlabelled(FakeEngine::bytes(8000, 0));
  EXPECT_EQ(fit_to_engine({config, 1000, false, 250000, 20000000}, {engine_, views_, 3, 1200}, host).gaussians, 4000u);
  EXPECT_EQ(fit_to_engine({config, 1000, false, 250000, 20000000}, {engine_, views_, 0, 1200}, unlabelled).gaussians,
            8000u);
}

TEST_F(EngineMemoryFit, AStartThatOwnMemoryDoesNotHoldNamesItAndTheRemedy) {
  for (const uint64_t limit : {uint64_t(0), 1000 + FakeEngine::bytes(999, 3)}) {
    MemoryBudget host(uint64_t(1) << 40);
    try {
      fit({limit, 1000, 0}, host);
      FAIL() << limit;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kResources);
      EXPECT_THAT(e.what(), testing::HasSubstr("training on fake needs"));
      EXPECT_THAT(e.details().remedy, testing::HasSubstr("--device cpu"));
    }
  }
}

TEST_F(EngineMemoryFit, WithoutOwnMemoryEverythingIsTheHosts) {
  MemoryBudget host(FakeEngine::bytes(7000, 3));
  EXPECT_EQ(fit_to_engine({config_, 1000, false, 250000, 20000000}, {engine_, views_, 3, 1200}, host).gaussians, 7000u);
}

}  // namespace
}  // namespace aligngs
