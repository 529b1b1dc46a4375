// Another process asks a run to stop, to pause, to save.
#include "train/train_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "core/error.h"
#include "core/stop_signal.h"
#include "train/checkpoint.h"
#include "train/run_control.h"
#include "train/run_record.h"
#include "train/testing/fake_engine.h"
#include "train/testing/fake_runs.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

using TrainControl = test_train::RunOnFakeEngine;

TEST_F(TrainControl, StopRequestWritesACheckpointAndSaysHowToGoOn) {
  const TrainOptions o = options("a");
  const EngineFactory stopping = [](int) {
    auto engine = std::make_unique<test_train::FakeEngine>();
    engine->before_step = [](int64_t step) -> NonFinite {
      if (step == 20) request_stop();
      return {};
    };
    return engine;
  };
  try {
    train_run(o, stopping);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kInterrupted);
    EXPECT_THAT(e.details().remedy, HasSubstr("--resume"));
  }
  EXPECT_EQ(record(o).status, RunStatus::kStopped);
  EXPECT_TRUE(fs::exists(o.run / "checkpoints" / "step_000020.safetensors"));
}

TEST_F(TrainControl, FlagsStopPauseAndSaveAndTheResultIsTheSame) {
  using Flag = RunControl::Flag;
  const TrainOptions whole = options("whole");
  train_run(whole, plain_engine());
  const TrainOptions o = options("a");
  const RunControl control(o.run);
  RunStatus paused_status{};
  std::thread resume;
  const EngineFactory watched = [&](int) {
    auto engine = std::make_unique<test_train::FakeEngine>();
    engine->before_step = [&](int64_t step) -> NonFinite {
      EXPECT_TRUE(control.active());
      if (step == 5 || step == 12 || step == 20) std::this_thread::sleep_for(std::chrono::milliseconds(120));
      if (step == 4) control.ask(Flag::kCheckpoint);
      if (step == 11) {
        control.ask(Flag::kPause);
        control.ask(Flag::kSnapshot);
        resume = std::thread([&] {
          for (int i = 0; i < 500 && record(o).status != RunStatus::kPaused; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
          paused_status = record(o).status;
          control.withdraw(Flag::kPause);
        });
      }
      if (step == 19) control.ask(Flag::kStop);
      return {};
    };
    return engine;
  };
  EXPECT_EQ(kind_of([&] { train_run(o, watched); }), ErrorKind::kInterrupted);
  resume.join();
  EXPECT_EQ(paused_status, RunStatus::kPaused);
  EXPECT_EQ(record(o).status, RunStatus::kStopped);
  EXPECT_FALSE(control.asked(Flag::kStop)) << "an obeyed flag is gone";
  EXPECT_FALSE(control.active());
  EXPECT_FALSE(fs::exists(o.run / "live")) << "a snapshot ends with its training";
  TrainOptions again = o;
  again.resume = true;
  train_run(again, plain_engine());
  EXPECT_TRUE(ply(o) == ply(whole));
}

TEST_F(TrainControl, AFlagAsksForACheckpointOrASnapshotAtOnce) {
  using Flag = RunControl::Flag;
  TrainOptions o = options("a");
  for (const char* const set : {"checkpoint.keep=9", "checkpoint.keep_finished=true"}) o.config.sets.push_back(set);
  const RunControl control(o.run);
  bool snapshot = false;
  const EngineFactory watched = [&](int) {
    auto engine = std::make_unique<test_train::FakeEngine>();
    engine->before_step = [&](int64_t step) -> NonFinite {
      if (step == 4) {
        control.ask(Flag::kCheckpoint);
        control.ask(Flag::kSnapshot);
        std::this_thread::sleep_for(std::chrono::milliseconds(120));
      }
      if (step == 5) snapshot = fs::exists(o.run / "live" / "scene.ply");
      return {};
    };
    return engine;
  };
  train_run(o, watched);
  EXPECT_TRUE(snapshot);
  EXPECT_TRUE(fs::exists(o.run / "checkpoints" / "step_000004.safetensors"));
}

TEST_F(TrainControl, ARunThatIsBeingTrainedIsLeftAlone) {
  const TrainOptions o = options("a");
  train_run(o, plain_engine());
  const std::string before = ply(o);
  const RunLock lock(o.run);
  TrainOptions second = o;
  second.overwrite = true;
  EXPECT_EQ(kind_of([&] { train_run(second, plain_engine()); }), ErrorKind::kUsage);
  EXPECT_TRUE(ply(o) == before);
}

}  // namespace
}  // namespace aligngs
