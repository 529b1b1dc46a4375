#include "engine/benchmark/step_benchmark.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "engine/cpu/matrix_tiles.h"

namespace aligngs {
namespace {

TEST(BenchmarkRoomTest, HasTheTileStatisticsOfARealRoom) {
  BenchmarkRoom room;
  room.width = 320;
  room.height = 240;
  room.gaussians = 50000;
  room.channels = 0;
  ThreadPool pool(2);
  const cpu::TileStatistics t = cpu::tile_statistics(benchmark_model(room), benchmark_view(room, 0).data.camera,
                                                     benchmark_request().raster, pool);
  const double tiles = static_cast<double>(t.tiles), pixels = static_cast<double>(t.pixels);
  // Kitchen: 61 % in view, 415 pairs per tile of which 259 are used, 54 splats per pixel.
  EXPECT_NEAR(static_cast<double>(t.visible) / 50000, 0.61, 0.08);
  EXPECT_NEAR(static_cast<double>(t.pairs) / tiles, 415, 80);
  EXPECT_NEAR(static_cast<double>(t.used) / tiles, 259, 50);
  EXPECT_NEAR(static_cast<double>(t.active) / pixels, 54, 10);
  EXPECT_LE(t.used, t.pairs);
  EXPECT_LE(static_cast<double>(t.active), 64.0 * static_cast<double>(t.entries));
}

TEST(BenchmarkRoomTest, EveryPixelHasADepthAndALabel) {
  BenchmarkRoom room;
  room.width = 64;
  room.height = 48;
  room.gaussians = 10;
  room.channels = 7;
  for (int v = 0; v < kBenchmarkViews; ++v) {
    const TrainingView view = benchmark_view(room, v);
    for (const float z : view.data.prior_depth.data) EXPECT_TRUE(z > 0 && z < 20);
    for (const uint16_t label : view.data.labels.data) EXPECT_LT(label, 7);
    EXPECT_EQ(view.data.semantics.channels, 7);
  }
}

TEST(BenchmarkRoomTest, SizesOutOfRangeAreUsageErrors) {
  BenchmarkRoom room;
  room.width = 0;
  EXPECT_THROW(benchmark_model(room), Error);
  room = {};
  room.gaussians = 0;
  EXPECT_THROW(benchmark_view(room, 0), Error);
}

StepBenchmarkOptions small_benchmark() {
  StepBenchmarkOptions options;
  options.room = {64, 48, 2000, 7};
  options.threads = 2;
  options.steps = 3;
  return options;
}

TEST(StepBenchmarkTest, EveryStageIsTimedAndHasAFloor) {
  StepBenchmarkOptions options = small_benchmark();
  options.matrix_tiles = false;  // then every step forms its semantic rows
  for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
    options.blend = blend;
    const StepTiming timing = time_steps(options);
    EXPECT_GT(timing.seconds, 0);
    EXPECT_LE(timing.best_seconds, timing.seconds);
    EXPECT_GT(timing.touched, 0u);
    for (const std::string& stage : stage_names()) {
      ASSERT_EQ(timing.stages.count(stage), 1u) << stage;
      const StageWork work = stage_work(stage, timing, options.room);
      EXPECT_GT(work.vector_flops + work.matrix_flops + work.bytes, 0) << stage;
    }
    EXPECT_EQ(timing.stages.size(), stage_names().size());
    EXPECT_EQ(timing.samples.size(), 3u);
  }
}

TEST(StepBenchmarkTest, AStageWithoutWorkIsNotTimed) {
  StepBenchmarkOptions options = small_benchmark();
  options.room.channels = 0;
  const StepTiming plain = time_steps(options);
  EXPECT_EQ(plain.stages.count("semantic_rows"), 0u);
  EXPECT_EQ(plain.stages.count("semantics"), 0u);
  if (!matrix_tiles_available()) GTEST_SKIP() << "without AMX every step with semantics forms its rows";
  // each step leaves the rounded rows as the next one needs them
  const StepTiming tiles = time_steps(small_benchmark());
  EXPECT_EQ(tiles.stages.count("semantic_rows"), 0u);
  EXPECT_EQ(tiles.stages.count("semantics"), 1u);
}

TEST(StepBenchmarkTest, DensificationMovesEveryRowOfOldAndNewModel) {
  const StepBenchmarkOptions options = small_benchmark();
  const StepTiming timing = time_steps(options);
  EXPECT_GT(timing.densify_seconds, 0);
  EXPECT_GT(timing.densified, options.room.gaussians / 2);
  EXPECT_NE(timing.densified, options.room.gaussians);
  const double row = 4.0 * (11 + 48 + 7), before = 2000, after = static_cast<double>(timing.densified);
  const StageWork work = stage_work("densify", timing, options.room);
  EXPECT_EQ(work.bytes, 4.0 * 11 * 2 * before + row * 3 * (before + after));
  EXPECT_EQ(work.vector_flops, 0);
}

TEST(StepBenchmarkTest, AnyEngineIsTimed) {
  StepBenchmarkOptions options;
  options.room = {32, 32, 200, 3};
  options.steps = options.warm_up = 1;
  int asked_for = 0;
  options.threads = 1;
  options.make_engine = [&](int threads) {
    asked_for = threads;
    return make_cpu_engine(threads);
  };
  EXPECT_GT(time_steps(options).seconds, 0);
  EXPECT_EQ(asked_for, 1);
}

TEST(StepBenchmarkTest, TheFloorIsTheSlowerOfComputingAndMoving) {
  MachineCeilings machine;
  machine.fma_gflops = 100;
  machine.amx_gflops = 1000;
  machine.read_gbps = 10;
  machine.triad_gbps = 12;
  EXPECT_NEAR(floor_seconds(machine, 1e9, 1e9, 0), 0.011, 1e-12);
  EXPECT_NEAR(floor_seconds(machine, 0, 0, 12e9), 1.0, 1e-12);
  machine.amx_gflops = 0;  // products then run as multiply-adds
  EXPECT_NEAR(floor_seconds(machine, 1e9, 1e9, 0), 0.02, 1e-12);
}

}  // namespace
}  // namespace aligngs
