#include "train/trained_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "core/error.h"
#include "core/log.h"
#include "scene/scene_folder_for_tests.h"
#include "train/fake_engine.h"
#include "train/run_folder.h"
#include "train/train_run.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class TrainedRunTest : public testing::Test {
 protected:
  void SetUp() override {
    set_log_level(LogLevel::kSilent);
    base_ = test_scene::write_scene("base").parent_path();
    TrainOptions options;
    options.scene = base_ / "base";
    options.run = run_ = base_ / "run";
    options.config.iterations = 6;
    options.config.sets = {"checkpoint.every=3", "densify.residual_quantile=0", "densify.unsupported_min=0"};
    options.command_line = "aligngs train";
    options.progress.enabled = false;
    options.threads = 1;
    fs::remove_all(run_);
    train_run(options, [](int) { return std::make_unique<test_train::FakeEngine>(); });
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  std::string refusal(const fs::path& scene = {}) const {
    try {
      read_trained_run(run_, scene, CheckpointParts::kAll);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      return error.what();
    }
    return "";
  }

  fs::path base_, run_;
};

TEST_F(TrainedRunTest, HasTheSceneTheSettingsAndTheNewestCheckpoint) {
  const TrainedRun run = read_trained_run(run_, {}, CheckpointParts::kAll);
  EXPECT_EQ(run.state.iteration, 6);
  EXPECT_EQ(run.config.checkpoint.every, 3);
  EXPECT_FALSE(run.scene.views.empty());
}

TEST_F(TrainedRunTest, AFolderWithoutRunIsRefused) {
  fs::remove(run_ / "run.json");
  EXPECT_THAT(refusal(), HasSubstr("no run folder"));
}

TEST_F(TrainedRunTest, ASceneThatWasMovedIsAskedFor) {
  fs::rename(base_ / "base", base_ / "moved");
  EXPECT_THAT(refusal(), HasSubstr("--scene"));
  EXPECT_EQ(refusal(base_ / "moved"), "");
}

TEST_F(TrainedRunTest, ARunWithoutItsCheckpointsIsToldFromOneThatHasNotBegun) {
  fs::remove_all(RunFolder(run_).checkpoints());
  EXPECT_THAT(refusal(), HasSubstr("checkpoints of this run are gone"));
  fs::remove(RunFolder(run_).scene_ply());
  EXPECT_THAT(refusal(), HasSubstr("nothing has been trained here yet"));
}

}  // namespace
}  // namespace aligngs
