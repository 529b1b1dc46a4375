// Times of a training step and of each of its operations, on the benchmark's room (engine/benchmark).
//   engine_benchmark --benchmark_filter=Step              whole steps of every scene
//   engine_benchmark --benchmark_filter=Op/.*/640/200000/150/  the operations of scenes of one size
// Arguments: image width, Gaussians, channels, threads, percent of the pixels that the semantic loss takes, what it
// blends (0: probabilities, 1: logits). Every operation is timed inside whole steps, so it finds the caches as training
// leaves them. Its counters are its rates. `of_floor` is the share of the time that the ceilings of the machine,
// measured by this program, would allow. Operations that a scene's steps do not have are left out.
#include <benchmark/benchmark.h>

#include <functional>
#include <map>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "core/thread_pool.h"
#include "engine/benchmark/step_benchmark.h"
#include "engine/cpu/matrix_tiles.h"

namespace aligngs {
namespace {

struct Scene {
  int width = 640, gaussians = 200000, channels = 150, threads = 1;
  int percent = 25;  ///< of the pixels that the semantic loss of a step takes
  SemanticBlend blend = SemanticBlend::kProbabilities;

  auto key() const { return std::make_tuple(width, gaussians, channels, threads, percent, blend); }
  bool operator<(const Scene& other) const { return key() < other.key(); }
};

const MachineCeilings& ceilings(int threads) {
  static std::map<int, MachineCeilings> known;
  auto found = known.find(threads);
  if (found == known.end()) {
    ThreadPool pool(threads);
    found = known.emplace(threads, measure_ceilings(pool)).first;
  }
  return found->second;
}

BenchmarkRoom room_of(const Scene& scene) {
  BenchmarkRoom room;
  room.width = scene.width;
  room.height = room.width * 3 / 4;
  room.gaussians = static_cast<size_t>(scene.gaussians);
  room.channels = scene.channels;
  return room;
}

/// The steps of a scene are run once and serve all its benchmarks.
const StepTiming& timing_of(const Scene& scene) {
  static std::map<Scene, StepTiming> known;
  auto found = known.find(scene);
  if (found == known.end()) {
    StepBenchmarkOptions options;
    options.room = room_of(scene);
    options.threads = scene.threads;
    options.pixel_share = scene.percent / 100.0;
    options.blend = scene.blend;
    found = known.emplace(scene, time_steps(options)).first;
  }
  return found->second;
}

std::vector<int64_t> arguments_of(const Scene& scene) {
  return {scene.width,   scene.gaussians, scene.channels,
          scene.threads, scene.percent,   scene.blend == SemanticBlend::kLogits ? 1 : 0};
}
Scene scene_of(const benchmark::State& state) {
  const auto argument = [&](size_t i) { return static_cast<int>(state.range(i)); };
  return {argument(0), argument(1), argument(2),
          argument(3), argument(4), argument(5) == 1 ? SemanticBlend::kLogits : SemanticBlend::kProbabilities};
}

/// Rates of what has to be done, and how much of the time its floor explains.
void add_rates(const StageWork& work, const MachineCeilings& machine, double seconds, benchmark::State& state) {
  const double flops = work.vector_flops + work.matrix_flops;
  const double floor = floor_seconds(machine, work.vector_flops, work.matrix_flops, work.bytes);
  if (flops > 0) state.counters["GFLOP/s"] = 1e-9 * flops / seconds;
  state.counters["GB/s"] = 1e-9 * work.bytes / seconds;
  state.counters["floor_ms"] = 1e3 * floor;
  state.counters["of_floor"] = floor / seconds;
}

double total_of(const std::map<std::string, double>& stages) {
  double total = 0;
  for (const auto& stage : stages) total += stage.second;
  return total;
}

void Step(benchmark::State& state) {
  const StepTiming& timing = timing_of(scene_of(state));
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

/// One call is timed, not one per iteration.
void Densify(benchmark::State& state) {
  const Scene scene = scene_of(state);
  const StepTiming& timing = timing_of(scene);
  for (auto _ : state) state.SetIterationTime(timing.densify_seconds);
  add_rates(stage_work("densify", timing, room_of(scene)), ceilings(scene.threads), timing.densify_seconds, state);
}

void Render(benchmark::State& state) {
  const StepTiming& timing = timing_of(scene_of(state));
  for (auto _ : state) state.SetIterationTime(timing.render_seconds);
}

void Op(benchmark::State& state, const std::string& stage) {
  const Scene scene = scene_of(state);
  const StepTiming& timing = timing_of(scene);
  if (timing.stages.count(stage) == 0) {
    state.SkipWithError("no such stage in these steps");
    return;
  }
  size_t i = 0;
  for (auto _ : state) {
    const auto& sample = timing.samples[i++ % timing.samples.size()];
    state.SetIterationTime(sample.count(stage) > 0 ? sample.at(stage) : 0.0);
  }
  add_rates(stage_work(stage, timing, room_of(scene)), ceilings(scene.threads), timing.stages.at(stage), state);
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

void register_scene(const Scene& scene) {
  const auto add = [&](const std::string& name, const std::function<void(benchmark::State&)>& run) {
    benchmark::RegisterBenchmark(name.c_str(), run)
        ->Args(arguments_of(scene))
        ->UseManualTime()
        ->Iterations(20)
        ->Unit(benchmark::kMillisecond);
  };
  add("Step", Step);
  for (const std::string& stage : stage_names()) {
    if (scene.channels == 0 && stage.rfind("semantic", 0) == 0) continue;
    if (stage == "semantic_rows" && matrix_tiles_available()) continue;  // the optimiser keeps the rounded rows
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
  // The scene of the targets, on one thread and on all; then along each of its three sizes; then what else semantics
  // do.
  const auto scene = [&](int width, int gaussians, int channels) { return Scene{width, gaussians, channels, all}; };
  register_scene(scene(640, 200000, 150));
  if (all > 1) register_scene({640, 200000, 150, 1});
  for (const int gaussians : {50000, 500000}) register_scene(scene(640, gaussians, 150));
  for (const int channels : {0, 16, 40}) register_scene(scene(640, 200000, channels));
  for (const int gaussians : {50000, 200000}) register_scene(scene(320, gaussians, 150));
  register_scene(scene(320, 50000, 0));
  register_scene(scene(960, 200000, 150));
  register_scene(scene(640, 500000, 0));
  register_scene({640, 200000, 150, all, 100, SemanticBlend::kProbabilities});
  register_scene({640, 200000, 150, all, 25, SemanticBlend::kLogits});
  register_scene({640, 200000, 150, all, 100, SemanticBlend::kLogits});  // what preset paper does
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
