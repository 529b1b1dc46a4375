// Finished checkpoints that refer to scene.ply.
#include "train/checkpoint_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "core/error.h"
#include "core/log.h"
#include "core/random.h"
#include "gaussians/gaussian_ply.h"
#include "io/atomic_file.h"
#include "train/checkpoint.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class CheckpointScene : public testing::Test {
 protected:
  void SetUp() override {
    run_ = fs::path(testing::TempDir()) / "aligngs_checkpoint_scene_test" /
           testing::UnitTest::GetInstance()->current_test_info()->name() / "run";
    fs::remove_all(run_.parent_path());
    fs::create_directories(run_ / "checkpoints");
    set_log_level(LogLevel::kSilent);
    state_.iteration = 600;
    state_.trainable = false;
    state_.depth_scales = {1};
    state_.engine.model = trained_model();
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  /// Rotations of every length, as Adam leaves them.
  static GaussianModel trained_model() {
    GaussianModel model;
    model.semantic_channels = 5;
    model.sh_degree = 1;
    model.resize(5000);
    Random random(7);
    for (auto* values : {&model.positions, &model.log_scales, &model.opacity_logits, &model.sh, &model.rotations}) {
      for (float& v : *values) v = static_cast<float>(random.normal());
    }
    model.positions[1] = -0.0f;
    for (size_t k = 0; k < 4; ++k) model.rotations[4 + k] = 0;
    for (size_t k = 0; k < 4; ++k) model.rotations[8 + k] *= 1e-12f;
    model.rotations[13] = 1e-40f;
    for (size_t i = 0; i < model.semantics.size(); i += 9) model.semantics[i] = static_cast<float>(i);
    return model;
  }
  void finish() {
    write_gaussian_ply(run_ / "scene.ply", state_.engine.model);
    write_checkpoint(run_ / "checkpoints", state_, "scene", 1);
  }
  TrainingState read() const { return read_latest_checkpoint(run_ / "checkpoints", "scene").value(); }
  void expect_refused(const char* message) const {
    try {
      read();
      ADD_FAILURE() << "no error was thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      EXPECT_THAT(error.details().message, HasSubstr(message));
      EXPECT_EQ(error.details().path, run_ / "scene.ply");
      EXPECT_THAT(error.details().remedy, HasSubstr("put back the scene.ply of this run"));
    }
  }
  void expect_same_model(const GaussianModel& other) const {
    const GaussianModel& model = state_.engine.model;
    for (const auto part : {&GaussianModel::positions, &GaussianModel::log_scales, &GaussianModel::rotations,
                            &GaussianModel::opacity_logits, &GaussianModel::sh, &GaussianModel::semantics}) {
      ASSERT_EQ((other.*part).size(), (model.*part).size());
      EXPECT_EQ(std::memcmp((other.*part).data(), (model.*part).data(), (model.*part).size() * sizeof(float)), 0);
    }
    EXPECT_EQ(other.sh_degree, model.sh_degree);
    EXPECT_EQ(other.semantic_channels, model.semantic_channels);
  }

  fs::path run_;
  TrainingState state_;
};

TEST_F(CheckpointScene, TheModelComesBackBitForBit) {
  finish();
  const TrainingState back = read();
  EXPECT_TRUE(back.in_scene_file);
  EXPECT_FALSE(back.trainable);
  EXPECT_EQ(back.iteration, 600);
  expect_same_model(back.engine.model);
}

TEST_F(CheckpointScene, TheCheckpointIsATenthOfTheFullOne) {
  write_checkpoint(run_ / "checkpoints", state_, "scene", 1);
  const fs::path file = list_checkpoints(run_ / "checkpoints").front();
  const auto full = fs::file_size(file);
  finish();
  EXPECT_LT(10 * fs::file_size(file), full);
}

TEST_F(CheckpointScene, WithoutSceneFileTheCheckpointHoldsEverything) {
  write_checkpoint(run_ / "checkpoints", state_, "scene", 1);
  const TrainingState back = read();
  EXPECT_FALSE(back.in_scene_file);
  expect_same_model(back.engine.model);
}

TEST_F(CheckpointScene, ASceneFileOfAnotherModelIsNotReferredTo) {
  GaussianModel other = state_.engine.model;
  other.sh[7] = 2;
  write_gaussian_ply(run_ / "scene.ply", other);
  write_checkpoint(run_ / "checkpoints", state_, "scene", 1);
  expect_same_model(read().engine.model);
  write_file_atomically(run_ / "scene.ply", "no PLY");
  write_checkpoint(run_ / "checkpoints", state_, "scene", 1);
  expect_same_model(read().engine.model);
}

TEST_F(CheckpointScene, AStateToTrainOnNeedsNoSceneFile) {
  state_.trainable = true;
  finish();
  fs::remove(run_ / "scene.ply");
  expect_same_model(read().engine.model);
}

TEST_F(CheckpointScene, ARunCanBeMoved) {
  finish();
  const fs::path moved = run_.parent_path() / "moved run";
  fs::rename(run_, moved);
  expect_same_model(read_latest_checkpoint(moved / "checkpoints", "scene").value().engine.model);
}

TEST_F(CheckpointScene, AMissingSceneFileIsNamed) {
  finish();
  fs::remove(run_ / "scene.ply");
  expect_refused("which is gone");
}

TEST_F(CheckpointScene, AChangedSceneFileIsNamed) {
  finish();
  std::string bytes = read_file(run_ / "scene.ply");
  bytes[bytes.size() / 2] ^= 1;
  write_file_atomically(run_ / "scene.ply", bytes);
  expect_refused("is not the one");
  GaussianModel other = state_.engine.model;
  other.resize(4000);
  write_gaussian_ply(run_ / "scene.ply", other);
  expect_refused("is not the one");
}

}  // namespace
}  // namespace aligngs
