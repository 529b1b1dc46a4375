#include "train/opened_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/log.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "scene/testing/scene_folder.h"
#include "train/run_folder.h"
#include "train/testing/fake_engine.h"
#include "train/train_run.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class OpenedRunTest : public testing::Test {
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
      OpenedRun run = open_run(run_, scene);
      read_trained_state(run, CheckpointParts::kAll);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      return error.what();
    }
    return "";
  }

  fs::path base_, run_;
};

TEST_F(OpenedRunTest, HasTheSceneTheSettingsAndTheNewestCheckpoint) {
  OpenedRun run = open_run(run_, {});
  EXPECT_EQ(read_trained_state(run, CheckpointParts::kAll).iteration, 6);
  EXPECT_EQ(run.folder, run_);
  EXPECT_EQ(run.record.train.iterations, 6);
  EXPECT_EQ(run.config.checkpoint.every, 3);
  EXPECT_FALSE(run.scene.views.empty());
}

TEST_F(OpenedRunTest, CamerasThatTrainingMovedAreWhereItLeftThem) {
  TrainConfig config = open_run(run_, {}).config;
  config.optimizer.pose_rotation = config.optimizer.pose_translation = 1e-4;
  write_file_atomically(RunFolder(run_).config(), config_to_toml(config));
  nlohmann::json cameras = parse_json(read_file(RunFolder(run_).cameras()));
  for (nlohmann::json& camera : cameras) camera["position"] = {7, 8, 9};
  write_file_atomically(RunFolder(run_).cameras(), json_document(cameras));
  const OpenedRun before = open_run(run_, {});
  const SharedRun after = open_run_as_trained(run_, {});
  EXPECT_FALSE(before.cameras_placed);
  EXPECT_TRUE(after->cameras_placed);
  const size_t view = static_cast<size_t>(before.scene.train[0]);
  EXPECT_GT(norm(before.scene.views[view].camera.centre() - Vec3d{7, 8, 9}), 1);
  EXPECT_LT(norm(after->scene.views[view].camera.centre() - Vec3d{7, 8, 9}), 1e-9);
}

TEST_F(OpenedRunTest, AFolderWithoutRunIsRefused) {
  fs::remove(run_ / "run.json");
  EXPECT_THAT(refusal(), HasSubstr("no run folder"));
}

TEST_F(OpenedRunTest, AFolderThatIsMissingIsTold) {
  try {
    require_run_folder(base_ / "absent");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("there is no such folder"));
  }
}

TEST_F(OpenedRunTest, SettingsThatAreMissingAreTold) {
  fs::remove(RunFolder(run_).config());
  EXPECT_THAT(refusal(), HasSubstr("the settings of this run are missing"));
}

TEST_F(OpenedRunTest, ASceneThatWasMovedIsAskedFor) {
  fs::rename(base_ / "base", base_ / "moved");
  EXPECT_THAT(refusal(), HasSubstr("--scene"));
  EXPECT_EQ(refusal(base_ / "moved"), "");
}

TEST_F(OpenedRunTest, ARunWithoutItsCheckpointsIsToldFromOneThatHasNotBegun) {
  fs::remove_all(RunFolder(run_).checkpoints());
  EXPECT_THAT(refusal(), HasSubstr("checkpoints of this run are gone"));
  fs::remove(RunFolder(run_).scene_ply());
  EXPECT_THAT(refusal(), HasSubstr("checkpoints of this run are gone")) << "run.json tells that it was trained";
  RunRecord record = read_run_record(RunFolder(run_).record());
  record.trained.clear();
  write_run_record(RunFolder(run_).record(), record);
  EXPECT_THAT(refusal(), HasSubstr("nothing has been trained here yet"));
}

}  // namespace
}  // namespace aligngs
