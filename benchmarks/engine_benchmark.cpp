// Times of a training step and of each of its operations, on the benchmark's room (engine/benchmark).
//   engine_benchmark --benchmark_filter=Step              whole steps of every scene
//   engine_benchmark --benchmark_filter=Op/640/200000/150 the operations of one scene
// Arguments: image width, Gaussians, channels, threads. Every operation is timed inside whole steps, where it finds
// the caches as training leaves them; its counters are its rates and, as `of_floor`, the share of the time that the
// machine's own ceilings, measured by this same program, would allow.
#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <functional>
#include <thread>
#include <tuple>

#include "core/thread_pool.h"
#include "engine/benchmark/step_benchmark.h"

namespace aligngs {
namespace {

using SceneKey = std::tuple<int, int, int, int>;  ///< width, Gaussians, channels, threads

const MachineCeilings& ceilings(int threads) {
  static std::map<int, MachineCeilings> known;
  auto found = known.find(threads);
  if (found == known.end()) {
    ThreadPool pool(threads);
    found = known.emplace(threads, measure_ceilings(pool)).first;
  }
  return found->second;
}

BenchmarkRoom room_of(const SceneKey& key) {
  BenchmarkRoom room;
  room.width = std::get<0>(key);
  room.height = room.width * 3 / 4;
  room.gaussians = static_cast<size_t>(std::get<1>(key));
  room.channels = std::get<2>(key);
  return room;
}

/// The steps of a scene are run once and serve all its benchmarks.
const StepTiming& timing_of(const SceneKey& key) {
  static std::map<SceneKey, StepTiming> known;
  auto found = known.find(key);
  if (found == known.end()) {
    StepBenchmarkOptions options;
    options.room = room_of(key);
    options.threads = std::get<3>(key);
    found = known.emplace(key, time_steps(options)).first;
  }
  return found->second;
}

SceneKey key_of(const benchmark::State& state) {
  return {static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), static_cast<int>(state.range(2)),
          static_cast<int>(state.range(3))};
}

double total_of(const std::map<std::string, double>& stages) {
  double total = 0;
  for (const auto& stage : stages) total += stage.second;
  return total;
}

void Step(benchmark::State& state) {
  const StepTiming& timing = timing_of(key_of(state));
  size_t i = 0;
  for (auto _ : state) state.SetIterationTime(total_of(timing.samples[i++ % timing.samples.size()]));
  state.counters["best_ms"] = 1e3 * timing.best_seconds;
  state.counters["median_ms"] = 1e3 * timing.seconds;
  state.counters["cpu_ms"] = 1e3 * timing.cpu_seconds;
  state.counters["visible"] = static_cast<double>(timing.tiles.visible);
  state.counters["pairs_per_tile"] = static_cast<double>(timing.tiles.pairs) / static_cast<double>(timing.tiles.tiles);
  state.counters["used_per_tile"] = static_cast<double>(timing.tiles.used) / static_cast<double>(timing.tiles.tiles);
  state.counters["splats_per_pixel"] =
      static_cast<double>(timing.tiles.active) / static_cast<double>(timing.tiles.pixels);
  state.counters["peak_MB"] = static_cast<double>(timing.peak_memory_bytes) / 1e6;
}

void Densify(benchmark::State& state) {
  const StepTiming& timing = timing_of(key_of(state));
  for (auto _ : state) state.SetIterationTime(timing.densify_seconds);
}

void Render(benchmark::State& state) {
  const StepTiming& timing = timing_of(key_of(state));
  for (auto _ : state) state.SetIterationTime(timing.render_seconds);
}

void Op(benchmark::State& state, const std::string& stage) {
  const SceneKey key = key_of(state);
  const StepTiming& timing = timing_of(key);
  size_t i = 0;
  for (auto _ : state) {
    const auto& sample = timing.samples[i++ % timing.samples.size()];
    state.SetIterationTime(sample.count(stage) > 0 ? sample.at(stage) : 0.0);
  }
  const StageWork work = stage_work(stage, timing, room_of(key));
  const MachineCeilings& machine = ceilings(std::get<3>(key));
  const double seconds = timing.stages.at(stage);
  const double floor = floor_seconds(machine, work.vector_flops, work.matrix_flops, work.bytes);
  state.counters["GFLOP/s"] = 1e-9 * (work.vector_flops + work.matrix_flops) / seconds;
  state.counters["GB/s"] = 1e-9 * work.bytes / seconds;
  state.counters["floor_ms"] = 1e3 * floor;
  state.counters["of_floor"] = floor / seconds;
  state.counters["best_ms"] = 1e3 * timing.best_stages.at(stage);
}

/// The ceilings themselves, as the first lines of the output.
void Machine(benchmark::State& state) {
  const MachineCeilings& machine = ceilings(static_cast<int>(state.range(0)));
  for (auto _ : state) state.SetIterationTime(1);
  state.SetLabel(machine.instructions);
  state.counters["fma_GFLOP/s"] = machine.fma_gflops;
  state.counters["amx_GFLOP/s"] = machine.amx_gflops;
  state.counters["read_GB/s"] = machine.read_gbps;
  state.counters["triad_GB/s"] = machine.triad_gbps;
}

void register_scene(int width, int gaussians, int channels, int threads) {
  const auto add = [&](const std::string& name, const std::function<void(benchmark::State&)>& run) {
    benchmark::RegisterBenchmark(name.c_str(), run)
        ->Args({width, gaussians, channels, threads})
        ->UseManualTime()
        ->Iterations(20)
        ->Unit(benchmark::kMillisecond);
  };
  add("Step", Step);
  for (const std::string& stage : stage_names()) {
    if (channels == 0 && stage.rfind("semantic", 0) == 0) continue;
    add("Op/" + stage, [stage](benchmark::State& state) { Op(state, stage); });
  }
  add("Op/densify", Densify);
  add("Op/render", Render);
}

void register_all() {
  const int all = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  for (const int threads : {1, all}) {
    benchmark::RegisterBenchmark("Machine", Machine)
        ->Args({threads})
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
    if (threads == all) break;
  }
  // The scene of the targets, on one thread and on all; then along each of its three sizes.
  register_scene(640, 200000, 150, all);
  if (all > 1) register_scene(640, 200000, 150, 1);
  for (const int gaussians : {50000, 500000}) register_scene(640, gaussians, 150, all);
  for (const int channels : {0, 16, 40}) register_scene(640, 200000, channels, all);
  for (const int gaussians : {50000, 200000}) register_scene(320, gaussians, 150, all);
  register_scene(320, 50000, 0, all);
  register_scene(960, 200000, 150, all);
  register_scene(640, 500000, 0, all);
}

}  // namespace
}  // namespace aligngs

int main(int argc, char** argv) {
  aligngs::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
