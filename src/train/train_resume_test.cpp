// Runs that were killed, changed or damaged, and go on.
#include "train/train_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/stop_signal.h"
#include "io/atomic_file.h"
#include "scene/testing/scene_folder.h"
#include "train/checkpoint.h"
#include "train/run_folder.h"
#include "train/run_record.h"
#include "train/testing/fake_engine.h"
#include "train/testing/fake_runs.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

using TrainResume = test_train::RunOnFakeEngine;

TEST_F(TrainResume, KilledAnywhereAndResumedEndsByteIdentical) {
  const TrainOptions whole = options("whole");
  train_run(whole, plain_engine());
  for (const int64_t at : {1, 9, 10, 30}) {
    TrainOptions o = options("killed_at_" + std::to_string(at));
    EXPECT_THROW(train_run(o, engine_killed_at(at)), Killed);
    o.resume = true;
    train_run(o, plain_engine());
    EXPECT_TRUE(ply(o) == ply(whole)) << at;
    EXPECT_TRUE(read_file(o.run / "scene.labels.ply") == read_file(whole.run / "scene.labels.ply")) << at;
  }
}

TEST_F(TrainResume, KilledTwiceAndResumedEndsByteIdentical) {
  const TrainOptions whole = options("whole");
  train_run(whole, plain_engine());
  TrainOptions o = options("killed");
  EXPECT_THROW(train_run(o, engine_killed_at(20)), Killed);
  o.resume = true;
  EXPECT_THROW(train_run(o, engine_killed_at(28)), Killed);
  train_run(o, plain_engine());
  EXPECT_TRUE(ply(o) == ply(whole));
}

TEST_F(TrainResume, WritingCheckpointsChangesNothing) {
  TrainOptions rare = options("rare");
  rare.config.sets[0] = "checkpoint.every=1000";
  TrainOptions often = options("often");
  often.config.sets[0] = "checkpoint.every=1";
  train_run(rare, plain_engine());
  train_run(often, plain_engine());
  EXPECT_TRUE(ply(rare) == ply(often));
}

TEST_F(TrainResume, ACheckpointShortBeforeTheEndIsLeftToTheLastOne) {
  const auto at_28 = [this](const char* every) {
    TrainOptions o = options(every);
    o.config.sets[0] = std::string("checkpoint.every=") + every;
    EXPECT_THROW(train_run(o, engine_killed_at(28)), Killed);
    return list_checkpoints(o.run / "checkpoints");
  };
  EXPECT_TRUE(at_28("25").empty()) << "five of 25 steps are left";
  const std::vector<fs::path> kept = at_28("22");
  ASSERT_EQ(kept.size(), 1u) << "eight of 22 steps are left";
  EXPECT_EQ(kept.front().filename(), "step_000022.safetensors");
}

TEST_F(TrainResume, EventsOfAResumedRunHaveEachStepOnce) {
  TrainOptions o = options("a");
  EXPECT_THROW(train_run(o, engine_killed_at(23)), Killed);
  o.resume = true;
  train_run(o, plain_engine());
  const std::string text = read_file(o.run / "events.ndjson");
  for (int64_t step = 5; step <= 30; step += 5) {
    const std::string needle = "{\"step\":" + std::to_string(step) + ",\"view\"";
    EXPECT_NE(text.find(needle), std::string::npos) << step;
    EXPECT_EQ(text.find(needle), text.rfind(needle)) << step;
  }
}

TEST_F(TrainResume, ResumeBeginsARunThatDoesNotExist) {
  TrainOptions o = options("a");
  o.resume = true;
  EXPECT_EQ(train_run(o, plain_engine()).iterations, 30);
}

TEST_F(TrainResume, ResumeTakesItsSettingsFromTheRun) {
  TrainOptions o = options("a");
  EXPECT_THROW(train_run(o, engine_killed_at(20)), Killed);
  o.resume = true;
  o.config = {};
  o.scene.clear();  // run.json knows the scene
  train_run(o, plain_engine());
  const TrainOptions whole = options("whole");
  train_run(whole, plain_engine());
  EXPECT_TRUE(ply(o) == ply(whole));
}

TEST_F(TrainResume, ResumeWithAnotherSceneTouchesNothing) {
  const fs::path other = base_ / "other";
  fs::copy(scene_, other, fs::copy_options::recursive);
  fs::remove_all(other / "pred_depths");
  for (const int64_t kill_at : {int64_t(20), int64_t(-1)}) {  // stopped, and finished
    TrainOptions o = options(kill_at < 0 ? "finished" : "stopped");
    try {
      train_run(o, engine_killed_at(kill_at));
    } catch (const Killed&) {
    }
    const std::string before = read_file(RunFolder(o.run).record());
    o.resume = true;
    o.scene = other;
    try {
      train_run(o, plain_engine());
      ADD_FAILURE() << "trained";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      EXPECT_THAT(error.what(), HasSubstr("another scene"));
    }
    EXPECT_EQ(read_file(RunFolder(o.run).record()), before);
    o.scene = base_ / "moved";
    fs::copy(scene_, o.scene, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    EXPECT_NO_THROW(train_run(o, plain_engine())) << "the same scene in another place";
  }
}

TEST_F(TrainResume, ResumeRefusesOtherSettings) {
  TrainOptions o = options("a");
  EXPECT_THROW(train_run(o, engine_killed_at(20)), Killed);
  o.resume = true;
  o.config.sets.push_back("loss.l1=0.5");
  EXPECT_EQ(kind_of([&] { train_run(o, plain_engine()); }), ErrorKind::kUsage);
}

TEST_F(TrainResume, DamagedNewestCheckpointFallsBackAndEndsTheSame) {
  const TrainOptions whole = options("whole");
  train_run(whole, plain_engine());
  TrainOptions o = options("damaged");
  EXPECT_THROW(train_run(o, engine_killed_at(23)), Killed);
  const fs::path newest = list_checkpoints(o.run / "checkpoints").front();
  fs::resize_file(newest, fs::file_size(newest) - 9);
  o.resume = true;
  train_run(o, plain_engine());
  EXPECT_TRUE(ply(o) == ply(whole));
}

TEST_F(TrainResume, ChangedSceneIsRefused) {
  TrainOptions o = options("a");
  EXPECT_THROW(train_run(o, engine_killed_at(20)), Killed);
  fs::remove_all(scene_);
  SceneWriter writer(scene_, false);
  for (int i = 0; i < 3; ++i) {
    SceneViewParts view = test_scene::view_parts(i);
    view.camera.world_to_camera.translation.y = 0.1;
    view.truth_camera = view.camera;
    writer.add_view(view);
  }
  writer.finish(test_scene::scene_parts());
  o.resume = true;
  EXPECT_EQ(kind_of([&] { train_run(o, plain_engine()); }), ErrorKind::kBadInput);
}

}  // namespace
}  // namespace aligngs
