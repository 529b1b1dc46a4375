// Nothing in training may depend on the unit of the world: a scene times 4 and 16 has the same losses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/atomic_file.h"
#include "io/json_text.h"
#include "train/config_keys.h"
#include "train/loss_schedule.h"
#include "train/run_folder.h"
#include "train/testing/textured_scene.h"
#include "train/train_run.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using Losses = std::map<std::string, double>;
using Sets = std::vector<std::string>;

// Powers of two leave every float32 as exact as it was; what is left are logarithms of scales.
constexpr double kScales[] = {4, 16};
constexpr double kSameStep = 1e-5;   // share of a loss in one step: six digits, as a user sees them
constexpr double kSameSteps = 2e-3;  // after kSteps, in which rounding may grow
constexpr double kNothing = 1e-5;    // beside 1: terms such as 1 - correlation are small differences of large numbers
constexpr int kSteps = 24;
constexpr double kBump = 0.02;  // error of the prior depth

Sets joined(Sets a, const Sets& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Every loss of the schedule acts in the first step, but the correlation does so without L_z alone.
Sets every_term(bool log_depth) {
  Sets sets = {"loss.multi_view_from=0", "loss.normal_start=0", "loss.depth_start=0"};
  for (const ScheduledLoss& row : scheduled_losses()) {
    const std::string key(row.key), weight = row.loss == Loss::kLogDepth && !log_depth ? "=0" : "=0.05";
    sets.push_back(key + weight);
    if (row.end != nullptr) sets.push_back(key + "_end" + weight);
  }
  return sets;
}

class ScaleInvariance : public test_train::QuietRuns {
 protected:
  /// The losses of the last step of a run on the scene times `scale`.
  Losses last_losses(double scale, const std::string& preset, int64_t steps, const Sets& sets) const {
    static std::map<double, fs::path> scenes;
    if (!scenes.contains(scale))
      scenes[scale] = test_train::write_textured_scene("scale" + std::to_string(scale), {scale, kBump});
    TrainOptions o;
    o.scene = scenes[scale];
    o.run = base_ / ("run" + std::to_string(runs_++));
    o.config.preset = preset;
    o.config.iterations = steps;
    o.config.sets = joined({"train.log_every=1"}, sets);
    o.progress.enabled = false;
    o.threads = 1;
    train_run(o);
    std::istringstream lines(read_file(RunFolder(o.run).events()));
    Losses losses;
    for (std::string line; std::getline(lines, line);) {
      const nlohmann::json event = parse_json(line);
      if (event.is_object() && event.contains("losses") && event["step"] == steps)
        losses = event["losses"].get<Losses>();
    }
    return losses;
  }

  static void expect_same(const Losses& got, const Losses& want, double share, const std::string& what) {
    ASSERT_FALSE(want.empty());
    ASSERT_EQ(got.size(), want.size());
    for (const auto& [term, value] : want)
      EXPECT_NEAR(got.at(term), value, share * std::abs(value) + kNothing) << term << ", " << what;
  }

 private:
  mutable int runs_ = 0;
};

TEST_F(ScaleInvariance, EveryLossOfTheFirstStep) {
  Losses acted;
  for (const bool log_depth : {true, false}) {
    const Sets sets = every_term(log_depth);
    const Losses want = last_losses(1, "default", 1, sets);
    for (const auto& [term, value] : want) acted[term] += std::abs(value);
    for (const double scale : kScales)
      expect_same(last_losses(scale, "default", 1, sets), want, kSameStep, "scale " + std::to_string(scale));
  }
  for (const auto& [term, value] : acted) EXPECT_GT(value, 0) << term << " did not act, so nothing is known of it";
}

TEST_F(ScaleInvariance, EveryPresetInItsFirstStep) {
  for (const char* preset : {"preview", "default", "high", "paper", "pgsr"}) {
    const Losses want = last_losses(1, preset, 1, {});
    for (const double scale : kScales) expect_same(last_losses(scale, preset, 1, {}), want, kSameStep, preset);
  }
}

/// A key that is a share of the extent. It has values with different effects on a short run, and the other settings
/// that it needs.
struct ShareOfExtent {
  const char* key;
  double acting, other;
  Sets with;
  const char* preset = "default";
};

// Density control and free space act within kSteps.
const Sets kGrowth = {"train.reference_iterations=24",
                      "densify.start=2",
                      "densify.stop=23",
                      "densify.every=4",
                      "densify.min_epochs=0",
                      "densify.gradient=1e-7",
                      "densify.max_growth=0",
                      "densify.max_gaussians=5000",
                      "densify.prune_scale_start=0",
                      "densify.residual_quantile=0",
                      "densify.unsupported_min=0"};
const Sets kCameras = {"train.reference_iterations=24", "optimizer.pose_start=0", "optimizer.pose_stop=24"};
const Sets kFreeSpace = {"train.reference_iterations=24", "densify.free_space_every=5", "densify.free_space_prior=0",
                         "densify.free_space_rendered=1"};

const std::vector<ShareOfExtent>& shares() {
  static const std::vector<ShareOfExtent> rows = {
      {"init.scale_max", 0.01, 0.05, {}},
      {"train.near_plane",
       0.9,
       0.02,
       {"train.near_share=0", "init.start=random", "init.random_count=2000", "densify.enabled=false",
        "densify.free_space_every=0"}},
      {"loss.flatten", 300, 0, {}},
      {"loss.scale_l1", 30, 0, {}},
      {"densify.small_scale", 1e-4, 1, kGrowth},
      {"densify.prune_scale", 0.07, 0,
       joined(kGrowth, {"init.start=cloud", "init.scale_max=0", "densify.small_scale=1"})},
      {"densify.free_space_offset", 0.002, 0.9, kFreeSpace},
      {"optimizer.position", 1e-3, 1e-5, {"optimizer.position_end=1e-5"}},
      {"optimizer.position_end", 1e-2, 1e-6, {}},
      {"optimizer.pose_translation", 1e-3, 0, kCameras},
      {"optimizer.scale_max", 0.005, 0, {}},
  };
  return rows;
}

std::string assignment(const char* key, double value) { return std::string(key) + "=" + std::to_string(value); }

TEST_F(ScaleInvariance, EveryKeyThatIsAShareOfTheExtent) {
  for (const ShareOfExtent& row : shares()) {
    const Sets acting = joined(row.with, {assignment(row.key, row.acting)});
    const Losses want = last_losses(1, row.preset, kSteps, acting);
    const Losses other = last_losses(1, row.preset, kSteps, joined(row.with, {assignment(row.key, row.other)}));
    EXPECT_GT(std::abs(other.at("l1") / want.at("l1") - 1), 4 * kSameSteps)
        << row.key << " does nothing here, so nothing is known of it";
    for (const double scale : kScales)
      expect_same(last_losses(scale, row.preset, kSteps, acting), want, kSameSteps, row.key);
  }
}

TEST(SharesOfTheExtent, AreAllTested) {
  std::vector<std::string> tested, documented = {"optimizer.position_end"};  // "the same at the end"
  for (const ShareOfExtent& row : shares()) tested.push_back(row.key);
  for (const ConfigKey& key : config_keys()) {
    if (key.doc.find("/ extent") != std::string_view::npos) documented.emplace_back(key.name);
  }
  EXPECT_THAT(tested, testing::UnorderedElementsAreArray(documented));
}

}  // namespace
}  // namespace aligngs
