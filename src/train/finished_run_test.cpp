// The files that a run keeps when its training is over.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "train/checkpoint.h"
#include "train/testing/fake_runs.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class FinishedRun : public test_train::RunOnFakeEngine {
 protected:
  /// As if the run had been killed before it wrote down that it is trained.
  static void unfinish(const TrainOptions& o) {
    RunRecord unfinished = record(o);
    unfinished.trained.clear();
    write_run_record(RunFolder(o.run).record(), unfinished);
  }
  static TrainingState newest_checkpoint(const TrainOptions& o) {
    return read_checkpoint(list_checkpoints(o.run / "checkpoints").front(), record(o).fingerprint);
  }
};

TEST_F(FinishedRun, KeepsOneCheckpointWithoutTheOptimiser) {
  const TrainOptions small = options("small");
  train_run(small, plain_engine());
  TrainOptions whole = options("whole");
  whole.config.sets.push_back("checkpoint.keep_finished=true");
  train_run(whole, plain_engine());
  const auto left = list_checkpoints(small.run / "checkpoints"), kept = list_checkpoints(whole.run / "checkpoints");
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(kept.size(), 2u);
  const std::string fingerprint = record(small).fingerprint;
  const TrainingState lean = read_checkpoint(left.front(), fingerprint),
                      full = read_checkpoint(kept.front(), fingerprint);
  EXPECT_FALSE(lean.trainable);
  EXPECT_TRUE(lean.engine.arrays.empty());
  EXPECT_TRUE(full.trainable);
  EXPECT_TRUE(lean.in_scene_file);
  EXPECT_EQ(lean.engine.model.positions, full.engine.model.positions);
  EXPECT_EQ(lean.engine.model.rotations, full.engine.model.rotations);
  EXPECT_EQ(lean.engine.model.semantics, full.engine.model.semantics);
  EXPECT_TRUE(ply(small) == ply(whole)) << "what is kept changes no result";
}

TEST_F(FinishedRun, KilledAfterItsLastCheckpointItEndsTheSame) {
  const TrainOptions whole = options("whole");
  train_run(whole, plain_engine());
  TrainOptions o = options("a");
  train_run(o, plain_engine());
  fs::remove(o.run / "scene.labels.ply");  // which follows the checkpoint
  unfinish(o);
  o.resume = true;
  EXPECT_FALSE(train_run(o, plain_engine()).already_finished);
  EXPECT_TRUE(ply(o) == ply(whole));
  EXPECT_TRUE(read_file(o.run / "scene.labels.ply") == read_file(whole.run / "scene.labels.ply"));
}

TEST_F(FinishedRun, KilledBetweenItsSceneAndItsLastCheckpointItEndsTheSame) {
  TrainOptions whole = options("whole"), o = options("a");
  train_run(whole, plain_engine());
  EXPECT_THROW(train_run(o, engine_killed_at(28)), Killed);
  fs::copy_file(whole.run / "scene.ply", o.run / "scene.ply");  // the checkpoint is that of an earlier step
  o.resume = true;
  EXPECT_EQ(train_run(o, plain_engine()).iterations, 30);
  EXPECT_TRUE(ply(o) == ply(whole));
  EXPECT_TRUE(newest_checkpoint(o).in_scene_file);
}

TEST_F(FinishedRun, ResumedWithoutItsSceneItSaysWhatIsMissingAndKeepsItsCheckpoint) {
  TrainOptions o = options("a");
  train_run(o, plain_engine());
  const std::string scene = ply(o);
  fs::remove(o.run / "scene.ply");
  unfinish(o);
  o.resume = true;
  try {
    train_run(o, plain_engine());
    ADD_FAILURE() << "no error was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_THAT(error.what(), HasSubstr("needs its scene.ply, which is gone"));
  }
  write_file_atomically(o.run / "scene.ply", scene);
  EXPECT_EQ(train_run(o, plain_engine()).iterations, 30);
}

TEST_F(FinishedRun, MoreIterationsNeedTheOptimiserAndNothingIsTouched) {
  TrainOptions o = options("a");
  train_run(o, plain_engine());
  const std::string config = read_file(o.run / "config.toml"), json = read_file(o.run / "run.json");
  o.resume = true;
  o.config = {};
  o.config.iterations = 40;
  try {
    train_run(o, plain_engine());
    ADD_FAILURE() << "no error was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    EXPECT_THAT(error.what(), HasSubstr("beyond iteration 30"));
    EXPECT_THAT(error.details().remedy, HasSubstr("checkpoint.keep_finished=true"));
  }
  EXPECT_EQ(read_file(o.run / "config.toml"), config);
  EXPECT_EQ(read_file(o.run / "run.json"), json);
}

TEST_F(FinishedRun, WithoutItsCheckpointsItIsNotTrainedAgain) {
  TrainOptions o = options("a");
  train_run(o, plain_engine());
  fs::remove_all(o.run / "checkpoints");
  const std::string json = read_file(o.run / "run.json");
  o.resume = true;
  EXPECT_TRUE(train_run(o, plain_engine()).already_finished);
  o.config = {};
  o.config.iterations = 40;
  EXPECT_EQ(kind_of([&] { train_run(o, plain_engine()); }), ErrorKind::kUsage);
  EXPECT_EQ(read_file(o.run / "run.json"), json);
}

TEST_F(FinishedRun, AStoppedRunWithoutItsCheckpointsDoesNotBeginAgain) {
  TrainOptions o = options("a");
  train_run(o, plain_engine());
  RunRecord stopped = record(o);
  stopped.status = RunStatus::kStopped;
  stopped.trained.clear();
  stopped.train.iterations = 20;
  write_run_record(o.run / "run.json", stopped);
  fs::remove_all(o.run / "checkpoints");
  o.resume = true;
  try {
    train_run(o, plain_engine());
    ADD_FAILURE() << "no error was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_THAT(error.what(), HasSubstr("stopped after 20 iterations, and its checkpoints are gone"));
  }
}

TEST_F(FinishedRun, ResumingItChangesNothing) {
  TrainOptions o = options("a");
  train_run(o, plain_engine());
  const std::string before = read_file(o.run / "run.json");
  const auto written = fs::last_write_time(o.run / "scene.ply");
  o.resume = true;
  const TrainResult again = train_run(o, plain_engine());
  EXPECT_TRUE(again.already_finished);
  EXPECT_EQ(again.iterations, 30);
  EXPECT_EQ(read_file(o.run / "run.json"), before);
  EXPECT_EQ(fs::last_write_time(o.run / "scene.ply"), written);
}

TEST_F(FinishedRun, MoreIterationsExtendAFinishedRunThatKeptItsOptimiser) {
  TrainOptions o = options("a");
  o.config.sets.push_back("checkpoint.keep_finished=true");
  train_run(o, plain_engine());
  o.resume = true;
  o.config = {};
  o.config.iterations = 40;
  EXPECT_EQ(train_run(o, plain_engine()).iterations, 40);
  EXPECT_THAT(read_file(o.run / "config.toml"), HasSubstr("schedule_iterations = 30"));
  EXPECT_EQ(record(o).train.iterations, 40);
  o.config.iterations = 35;
  EXPECT_EQ(kind_of([&] { train_run(o, plain_engine()); }), ErrorKind::kUsage);
}

}  // namespace
}  // namespace aligngs
