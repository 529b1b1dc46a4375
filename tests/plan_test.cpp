// A run as a plan: what --dry-run prints, and that a run writes nowhere but into its own folder.
#include <gmock/gmock.h>

#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/atomic_file.h"
#include "io/json_text.h"
#include "priors/testing/tiny_networks.h"
#include "scene/scene.h"
#include "support/no_weights.h"
#include "support/process.h"
#include "support/small_scene.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

class PlanCommand : public testing::Test {
 protected:
  static fs::path original() { return fs::path(testing::TempDir()) / "plan_command_original"; }
  static void SetUpTestSuite() {
    fs::remove_all(original());
    testing_support::write_small_scene(original());
  }
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) /
            ("plan_command_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(root_);
    no_weights_.emplace(root_);
    fs::create_directories(root_);
    fs::copy(original(), scene(), fs::copy_options::recursive);
  }
  fs::path scene() const { return root_ / "scene"; }
  fs::path run_folder() const { return root_ / "run"; }
  ProcessResult run(const std::string& options) const {
    return run_aligngs("run '" + scene().string() + "' -o '" + run_folder().string() + "' " + options,
                       fs::path(testing::TempDir()) / "plan_command_scratch");
  }
  /// Path and content of every file of a folder.
  static std::map<std::string, std::string> files(const fs::path& folder) {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      found[entry.path().string()] = entry.is_regular_file() ? read_file(entry.path()) : "";
    return found;
  }
  fs::path root_;
  std::optional<testing_support::NoWeights> no_weights_;
};

TEST_F(PlanCommand, ADryRunPrintsTheStepsAndTouchesNothing) {
  const auto before = files(root_);
  const ProcessResult result = run("-n 20 --dry-run");
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* step : {"poses", "depth", "classes", "measure", "refine", "train", "mesh", "report", "room"})
    EXPECT_THAT(result.out, HasSubstr(step));
  EXPECT_THAT(result.out, HasSubstr("20 iterations"));
  EXPECT_THAT(result.out, HasSubstr("unknown")) << "time of a first run";
  EXPECT_EQ(files(root_), before);
}

TEST_F(PlanCommand, ItsJsonHasAReasonForEveryStep) {
  const ProcessResult result = run("-n 20 --dry-run --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json plan = parse_json(result.out);
  EXPECT_EQ(plan["begun"], false);
  ASSERT_EQ(plan["steps"].size(), 12u);
  for (const auto& step : plan["steps"]) EXPECT_NE(step["reason"], "") << step;
  EXPECT_EQ(plan["steps"][0]["outlook"], "left out");
  EXPECT_TRUE(plan["steps"][6]["seconds"].is_null());
  EXPECT_GT(plan["memory_bytes"], 0);
}

TEST_F(PlanCommand, ADryRunFailsAsTheRunDoes) {
  for (const auto& entry : fs::recursive_directory_iterator(scene() / "sparse")) {
    if (entry.path().filename() == "cameras.bin") fs::resize_file(entry.path(), 9);
  }
  const ProcessResult dry = run("--dry-run"), real = run("");
  EXPECT_EQ(dry.status, 3) << dry.err;
  EXPECT_THAT(dry.err, HasSubstr("cameras.bin"));
  EXPECT_EQ(dry.err, real.err);
  EXPECT_FALSE(fs::exists(run_folder()));
}

TEST_F(PlanCommand, AnEmptyFolderIsNoSource) {
  fs::remove_all(scene());
  fs::create_directories(scene());
  const ProcessResult result = run("--dry-run");
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("neither a scene"));
}

TEST_F(PlanCommand, ADryRunOfTheDemoTouchesNothing) {
  const ProcessResult result = run_aligngs("demo -o '" + run_folder().string() + "' --dry-run",
                                           fs::path(testing::TempDir()) / "plan_command_scratch");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("synth"));
  EXPECT_FALSE(fs::exists(run_folder()));
}

TEST_F(PlanCommand, PriorsOfARunLieInTheScenesOfTheRun) {
  fs::remove_all(scene() / "pred_depths");
  fs::remove_all(scene() / "pred_confidence");
  fs::remove_all(scene() / "segmentation_logits");
  fs::remove(scene() / "priors.json");
  fs::remove(scene() / "labels.csv");
  fs::remove_all(scene() / "truth");
  tiny_networks::install_linear(ModelStore(ModelStoreOptions::from_environment(true)));
  const auto before = files(scene());
  const ProcessResult result = run("-n 2 -q --depth linear-s --no-refine");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(files(scene()), before);
  const Scene own = open_scene(run_folder() / "scene");
  EXPECT_TRUE(own.has_prior_depth());
  EXPECT_EQ(own.prior_source, "nyu-linear4-s");
  EXPECT_TRUE(own.has_semantics());
  EXPECT_EQ(own.semantic_source, "ade20k-linear-s");
}

}  // namespace
}  // namespace aligngs
