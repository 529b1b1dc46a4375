// Times of stages: all of them are there, and a timer that is off is not there at all.
#include "device/stage_timer.h"

#include <gtest/gtest.h>

#include "device/testing/device.h"

namespace aligngs::cuda {
namespace {

class CudaStageTimer : public DeviceTest {
 protected:
  /// Some work between two marks.
  void work() {
    DeviceArray<float> memory(context(), 1 << 20, "test");
    fill_zero(context(), memory.span());
  }
};

TEST_F(CudaStageTimer, EveryStageHasATimeAndARepeatedOneItsSum) {
  StageTimer timer(context(), true);
  timer.start();
  work();
  timer.mark("first");
  work();
  timer.mark("second");
  work();
  timer.mark("first");
  context().synchronise();
  std::map<std::string, double> seconds = {{"second", 100.0}};
  timer.read(seconds);
  EXPECT_EQ(seconds.size(), 2u);
  EXPECT_GT(seconds["first"], 0);
  EXPECT_GT(seconds["second"], 100.0) << "times are added to what is there";
}

TEST_F(CudaStageTimer, MarksBeforeStartAndAfterReadDoNothing) {
  StageTimer timer(context(), true);
  std::map<std::string, double> seconds;
  timer.mark("too early");
  context().synchronise();
  timer.read(seconds);
  timer.start();
  context().synchronise();
  timer.read(seconds);
  timer.mark("too late");
  timer.read(seconds);
  EXPECT_TRUE(seconds.empty());
}

TEST_F(CudaStageTimer, OffItHasNothingToRead) {
  StageTimer timer(context(), false);
  timer.start();
  timer.mark("first");
  context().synchronise();
  std::map<std::string, double> seconds;
  timer.read(seconds);
  EXPECT_TRUE(seconds.empty());
}

}  // namespace
}  // namespace aligngs::cuda
