#include "train/loss_schedule.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <variant>

#include "train/config_keys.h"

namespace aligngs {
namespace {

constexpr unsigned kAllOpen = ~0u;

/// Every setting of a weight has a value of its own.
TrainConfig numbered() {
  TrainConfig config = make_preset(Preset::kDefault);
  double value = 0.5;
  for (const ScheduledLoss& row : scheduled_losses()) {
    const_cast<double&>(row.start(config)) = value += 1;
    if (row.end != nullptr) const_cast<double&>(row.end(config)) = value += 1;
  }
  return config;
}

TEST(LossSchedule, EveryLossHasASettingOfItsOwn) {
  const TrainConfig config = numbered();
  const PerLoss<float> weights = scheduled_weights(config, kAllOpen, 0);
  std::set<float> different;
  for (const ScheduledLoss& row : scheduled_losses()) {
    EXPECT_NEAR(weights[row.loss], row.start(config), 1e-6 * row.start(config)) << row_of(row.loss).name;
    different.insert(weights[row.loss]);
  }
  EXPECT_EQ(different.size(), kLosses);
}

TEST(LossSchedule, KeysAreThoseOfTheValues) {
  TrainConfig config = numbered();
  const auto expect_key = [&](const std::string& name, const double& value) {
    const ConfigKey* key = find_config_key(name);
    ASSERT_NE(key, nullptr) << name;
    EXPECT_EQ(std::get<double*>(key->field(config)), &value) << name;
  };
  for (const ScheduledLoss& row : scheduled_losses()) {
    expect_key(std::string(row.key), row.start(config));
    if (row.end != nullptr) expect_key(std::string(row.key) + "_end", row.end(config));
  }
}

TEST(LossSchedule, InputsAreWantedWhereALossWithAWeightNeedsThem) {
  TrainConfig config = make_preset(Preset::kPaper);
  EXPECT_FALSE(settings_need(config, kNeedsPriorNormal));
  config.loss.crease = 0.1;
  EXPECT_TRUE(settings_need(config, kNeedsPriorNormal));
}

TEST(LossSchedule, AClosedGateSwitchesExactlyItsLossesOff) {
  const TrainConfig config = numbered();
  for (unsigned gate = kGateSemantics; gate <= kGateTwoViews; gate *= 2) {
    const PerLoss<float> weights = scheduled_weights(config, kAllOpen & ~gate, 0);
    size_t off = 0;
    for (const ScheduledLoss& row : scheduled_losses()) {
      EXPECT_EQ(weights[row.loss] == 0, (row.gates & gate) != 0) << row_of(row.loss).name;
      off += weights[row.loss] == 0 ? 1 : 0;
    }
    EXPECT_GT(off, 0u) << "no loss has gate " << gate;
  }
}

TEST(LossSchedule, ALossWithAnEndReachesIt) {
  const TrainConfig config = numbered();
  const PerLoss<float> weights = scheduled_weights(config, kAllOpen, 1);
  for (const ScheduledLoss& row : scheduled_losses()) {
    const double end = (row.end != nullptr ? row.end : row.start)(config);
    EXPECT_NEAR(weights[row.loss], end, 1e-6 * end) << row_of(row.loss).name;
  }
}

TEST(LossSchedule, ALossThatNeedsLabelsWaitsForThem) {
  for (const ScheduledLoss& row : scheduled_losses()) {
    if ((row_of(row.loss).needs & kNeedsLabels) != 0) {
      EXPECT_NE(row.gates & kGateSemantics, 0u) << row_of(row.loss).name;
    }
    if (row_of(row.loss).stage == LossStage::kTwoViews) {
      EXPECT_NE(row.gates & kGateTwoViews, 0u) << row_of(row.loss).name;
    }
  }
}

}  // namespace
}  // namespace aligngs
