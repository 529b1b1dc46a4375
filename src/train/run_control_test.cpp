#include "train/run_control.h"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "core/error.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using ControlFlag = RunControl::Flag;

class RunControlTest : public testing::Test {
 protected:
  void SetUp() override {
    run_ = fs::path(testing::TempDir()) / "aligngs_run_control" /
           testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(run_);
    fs::create_directories(run_);
  }
  fs::path run_;
};

TEST_F(RunControlTest, AFlagIsAFileThatStandsUntilItIsTaken) {
  const RunControl control(run_);
  EXPECT_FALSE(control.asked(ControlFlag::kStop));
  EXPECT_FALSE(control.take(ControlFlag::kStop));
  control.ask(ControlFlag::kStop);
  control.ask(ControlFlag::kStop);
  EXPECT_TRUE(fs::exists(run_ / "control" / "stop"));
  EXPECT_TRUE(control.asked(ControlFlag::kStop));
  EXPECT_FALSE(control.asked(ControlFlag::kPause));
  EXPECT_TRUE(control.take(ControlFlag::kStop));
  EXPECT_FALSE(control.take(ControlFlag::kStop));
}

TEST_F(RunControlTest, ARunIsActiveWhileItIsLocked) {
  const RunControl control(run_);
  EXPECT_FALSE(control.active());
  {
    const RunLock lock(run_);
    EXPECT_TRUE(control.active());
    EXPECT_TRUE(control.active()) << "asking does not take the lock away";
    try {
      const RunLock second(run_);
      ADD_FAILURE() << "two processes would work on one run";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    }
    EXPECT_TRUE(control.active());
  }
  EXPECT_FALSE(control.active());
  EXPECT_NO_THROW(RunLock{run_});
}

TEST_F(RunControlTest, AskingWhetherARunIsActiveNeverKeepsAWorkerOut) {
  const RunControl control(run_);
  { const RunLock once(run_); }
  std::atomic<bool> stop{false};
  std::thread asking([&] {
    while (!stop) control.active();
  });
  for (int i = 0; i < 20; ++i) EXPECT_NO_THROW(RunLock{run_}) << i;
  stop = true;
  asking.join();
}

TEST_F(RunControlTest, FlagsForAnEarlierProcessDoNotStopTheNext) {
  const RunControl control(run_);
  control.ask(ControlFlag::kStop);
  control.ask(ControlFlag::kPause);
  const RunLock lock(run_);
  EXPECT_FALSE(control.asked(ControlFlag::kStop));
  EXPECT_FALSE(control.asked(ControlFlag::kPause));
}

}  // namespace
}  // namespace aligngs
