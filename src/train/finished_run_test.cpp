// The files that a run keeps when its training is over.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "train/checkpoint.h"
#include "train/fake_runs_for_tests.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

using FinishedRun = test_train::RunOnFakeEngine;

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
  EXPECT_EQ(lean.engine.model.positions, full.engine.model.positions);
  EXPECT_EQ(lean.engine.model.semantics, full.engine.model.semantics);
  EXPECT_TRUE(ply(small) == ply(whole)) << "what is kept changes no result";
}

TEST_F(FinishedRun, KilledAfterItsLastCheckpointItEndsTheSame) {
  const TrainOptions whole = options("whole");
  train_run(whole, plain_engine());
  TrainOptions o = options("a");
  train_run(o, plain_engine());
  for (const char* const name : {"scene.ply", "scene.labels.ply"}) fs::remove(o.run / name);
  RunRecord unfinished = record(o);
  unfinished.trained.clear();
  write_run_record(RunFolder(o.run).record(), unfinished);
  o.resume = true;
  EXPECT_FALSE(train_run(o, plain_engine()).already_finished);
  EXPECT_TRUE(ply(o) == ply(whole));
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
