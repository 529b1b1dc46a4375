// The benchmark of a step on a device: the same program as on the CPU, with every stage timed by the device.
#include "engine/benchmark/step_benchmark.h"

#include <gtest/gtest.h>

#include "device/testing/device.h"
#include "engine/cuda/make_engine.h"

namespace aligngs::cuda {
namespace {

class CudaStepBenchmark : public DeviceTest {};

TEST_F(CudaStepBenchmark, EveryStageIsTimedAndHasAFloor) {
  StepBenchmarkOptions options;
  options.room = {32, 32, 150, 7};
  options.threads = 1;
  options.steps = 2;
  options.warm_up = kBenchmarkViews;  // every view once: the first visit to a view waits inside the step
  CudaEngineOptions settings;
  settings.time_stages = true;
  options.make_engine = [&](int threads) { return make_cuda_engine(context().device(), 0, threads, settings); };
  const StepTiming timing = time_steps(options);
  EXPECT_GT(timing.seconds, 0);
  EXPECT_GT(timing.touched, 0u);
  EXPECT_GT(timing.render_seconds, 0);
  EXPECT_EQ(timing.stages.size(), stage_names().size());
  double sum = 0;
  for (const std::string& stage : stage_names()) {
    ASSERT_EQ(timing.stages.count(stage), 1u) << stage;
    EXPECT_GT(timing.stages.at(stage), 0) << stage;
    const StageWork work = stage_work(stage, timing, options.room);
    EXPECT_GT(work.vector_flops + work.matrix_flops + work.bytes, 0) << stage;
    sum += timing.best_stages.at(stage);
  }
  EXPECT_LE(sum, timing.best_seconds) << "stages do not overlap";
}

}  // namespace
}  // namespace aligngs::cuda
