// `aligngs bench`: how fast this version trains on this machine, and how far that is from what the machine can do.
#include <CLI/App.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/choice_option.h"
#include "cli/command.h"
#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "core/error.h"
#include "core/memory_budget.h"
#include "core/version.h"
#include "device/device_ceilings.h"
#include "engine/benchmark/instruction_limit.h"
#include "engine/benchmark/step_benchmark.h"
#include "engine/cuda/make_engine.h"

namespace aligngs {
namespace {

struct BenchOptions {
  StepBenchmarkOptions steps;
  Instructions instructions = Instructions::kAll;
  std::string device = "cpu";
  cuda::CudaEngineOptions cuda;  ///< with a CUDA device
};

/// Yardstick of the stages.
struct BenchMachine {
  std::string line;         ///< for people
  nlohmann::json document;  ///< for programs
  MachineCeilings ceilings;
};

std::string rates_line(const MachineCeilings& c) {
  char text[160];
  std::snprintf(text, sizeof text, "%.0f GFLOP/s float32, ", c.fma_gflops);
  std::string line = text;
  if (c.amx_gflops > 0) {
    std::snprintf(text, sizeof text, "%.2f TFLOP/s bfloat16 tiles, ", 1e-3 * c.amx_gflops);
    line += text;
  }
  std::snprintf(text, sizeof text, "%.0f GB/s memory", std::max(c.read_gbps, c.triad_gbps));
  return line + text;
}

BenchMachine measure_cpu(int threads, bool matrix_tiles) {
  ThreadPool pool(threads);
  BenchMachine m;
  m.ceilings = measure_ceilings(pool, matrix_tiles);
  m.line = std::to_string(pool.size()) + " threads, " + m.ceilings.instructions + ": " + rates_line(m.ceilings);
  m.document = {{"threads", pool.size()},
                {"instructions", m.ceilings.instructions},
                {"fma_gflops", m.ceilings.fma_gflops},
                {"amx_gflops", m.ceilings.amx_gflops},
                {"read_gbps", m.ceilings.read_gbps},
                {"triad_gbps", m.ceilings.triad_gbps}};
  return m;
}

BenchMachine measure_device(int index, bool graphs) {
  const cuda::CudaDevices found = cuda::list_cuda_devices();
  const cuda::CudaDevice& device = *std::find_if(found.devices.begin(), found.devices.end(),
                                                 [&](const cuda::CudaDevice& d) { return d.index == index; });
  const cuda::DeviceCeilings c = cuda::measure_device_ceilings(index);
  BenchMachine m;
  m.ceilings.fma_gflops = c.fma_gflops;
  m.ceilings.amx_gflops = c.mma_gflops;
  m.ceilings.read_gbps = m.ceilings.triad_gbps = c.copy_gbps;
  m.line = "cuda:" + std::to_string(device.index) + ", " + device.name + (graphs ? ", CUDA graphs: " : ": ") +
           rates_line(m.ceilings);
  m.document = {{"device", "cuda:" + std::to_string(device.index)},
                {"name", device.name},
                {"compute_capability", std::to_string(device.major) + "." + std::to_string(device.minor)},
                {"build", cuda::cuda_build()},
                {"graphs", graphs},
                {"fma_gflops", c.fma_gflops},
                {"mma_gflops", c.mma_gflops},
                {"copy_gbps", c.copy_gbps}};
  return m;
}

double per(size_t a, size_t b) { return b > 0 ? static_cast<double>(a) / static_cast<double>(b) : 0.0; }

nlohmann::json stage_json(const std::string& stage, const StepTiming& timing, const BenchmarkRoom& room,
                          const MachineCeilings& machine) {
  const StageWork work = stage_work(stage, timing, room);
  const double seconds = timing.stages.at(stage);
  const double floor = floor_seconds(machine, work.vector_flops, work.matrix_flops, work.bytes);
  return {{"seconds", seconds},
          {"best_seconds", timing.best_stages.at(stage)},
          {"gflops", 1e-9 * (work.vector_flops + work.matrix_flops) / seconds},
          {"gbps", 1e-9 * work.bytes / seconds},
          {"floor_seconds", floor},
          {"fraction", floor / seconds}};
}

nlohmann::json densify_json(const StepTiming& timing, const BenchmarkRoom& room, const MachineCeilings& machine) {
  const double bytes = stage_work("densify", timing, room).bytes, floor = floor_seconds(machine, 0, 0, bytes);
  return {{"seconds", timing.densify_seconds},
          {"gaussians", timing.densified},
          {"gbps", 1e-9 * bytes / timing.densify_seconds},
          {"floor_seconds", floor},
          {"fraction", floor / timing.densify_seconds}};
}

nlohmann::json document_of(const StepTiming& timing, const BenchOptions& options, const BenchMachine& machine) {
  const BenchmarkRoom& room = options.steps.room;
  nlohmann::json stages = nlohmann::json::object();
  for (const std::string& stage : stage_names()) {
    if (timing.stages.count(stage) > 0) stages[stage] = stage_json(stage, timing, room, machine.ceilings);
  }
  const cpu::TileStatistics& t = timing.tiles;
  return {{"version", version()},
          {"scene",
           {{"width", room.width},
            {"height", room.height},
            {"gaussians", room.gaussians},
            {"channels", room.channels},
            {"order", room.morton_order ? "morton" : "scattered"},
            {"pixel_share", timing.pixel_share},
            {"blend", word_of(options.steps.blend)},
            {"visible", t.visible},
            {"pairs_per_tile", per(t.pairs, t.tiles)},
            {"used_per_tile", per(t.used, t.tiles)},
            {"splats_per_pixel", per(t.active, t.pixels)}}},
          {"machine", machine.document},
          {"step",
           {{"seconds", timing.seconds},
            {"best_seconds", timing.best_seconds},
            {"cpu_seconds", timing.cpu_seconds},
            {"stages", stages}}},
          {"densify", densify_json(timing, room, machine.ceilings)},
          {"render", {{"seconds", timing.render_seconds}}},
          {"peak_memory_bytes", timing.peak_memory_bytes}};
}

void print_table(const nlohmann::json& d, const std::string& machine) {
  const auto& scene = d["scene"];
  std::printf(
      "scene    %d x %d pixels, %zu Gaussians (%.0f in view, %.0f per tile, %.0f per pixel), %d channels, %s of %.0f "
      "%% of the pixels\n",
      scene["width"].get<int>(), scene["height"].get<int>(), scene["gaussians"].get<size_t>(),
      scene["visible"].get<double>(), scene["pairs_per_tile"].get<double>(), scene["splats_per_pixel"].get<double>(),
      scene["channels"].get<int>(), scene["blend"].get<std::string>().c_str(),
      100 * scene["pixel_share"].get<double>());
  std::printf("machine  %s\n\n", machine.c_str());
  std::printf("%-14s %9s %9s %9s %8s %9s %9s\n", "stage", "median ms", "best ms", "GFLOP/s", "GB/s", "floor ms",
              "of floor");
  for (const std::string& stage : stage_names()) {
    if (!d["step"]["stages"].contains(stage)) continue;
    const auto& s = d["step"]["stages"][stage];
    std::printf("%-14s %9.2f %9.2f %9.1f %8.1f %9.2f %8.0f%%\n", stage.c_str(), 1e3 * s["seconds"].get<double>(),
                1e3 * s["best_seconds"].get<double>(), s["gflops"].get<double>(), s["gbps"].get<double>(),
                1e3 * s["floor_seconds"].get<double>(), 100 * s["fraction"].get<double>());
  }
  std::printf("%-14s %9.2f %9.2f   (%.2f ms of processor time per thread)\n\n", "step",
              1e3 * d["step"]["seconds"].get<double>(), 1e3 * d["step"]["best_seconds"].get<double>(),
              1e3 * d["step"]["cpu_seconds"].get<double>());
  std::printf(
      "%.1f steps per second; densification %.0f ms a call (floor %.0f ms); rendering %.0f ms a view; peak memory %s\n",
      1 / d["step"]["seconds"].get<double>(), 1e3 * d["densify"]["seconds"].get<double>(),
      1e3 * d["densify"]["floor_seconds"].get<double>(), 1e3 * d["render"]["seconds"].get<double>(),
      format_bytes(d["peak_memory_bytes"].get<uint64_t>()).c_str());
}

BenchMachine run_on_cpu(BenchOptions& o, StepTiming& timing) {
  o.steps.matrix_tiles = o.instructions == Instructions::kAll;
  const InstructionLimit limit(o.instructions);
  timing = time_steps(o.steps);
  return measure_cpu(o.steps.threads, o.steps.matrix_tiles);
}

BenchMachine run_on_device(BenchOptions& o, int index, StepTiming& timing) {
  o.cuda.time_stages = true;
  // Every view once: the first visit to a view waits inside the step.
  o.steps.warm_up = std::max(o.steps.warm_up, kBenchmarkViews);
  o.steps.make_engine = [&](int threads) { return make_cuda_engine(index, 0, threads, o.cuda); };
  timing = time_steps(o.steps);
  return measure_device(index, o.cuda.graphs);
}

void run_bench(BenchOptions& o, bool json) {
  StepTiming timing;
  BenchMachine machine;
  const cuda::DeviceChoice choice = chosen_device(o.device, true);
  if (choice.cuda) {
    if (o.instructions != Instructions::kAll) throw_usage("--instructions are those of the CPU", "leave --device out");
    machine = run_on_device(o, choice.index, timing);
  } else {
    if (o.cuda.graphs) throw_usage("--graphs are those of a CUDA device", "choose one: --device cuda:0");
    machine = run_on_cpu(o, timing);
  }
  const nlohmann::json document = document_of(timing, o, machine);
  if (json) {
    print_json(document);
  } else {
    print_table(document, machine.line);
  }
}

}  // namespace

void add_bench_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("bench", "Time a training step on this machine, stage by stage");
  command->group("Look");
  command->footer(help_footer({.reads = "nothing: the scene is made up",
                               .writes = "a table on standard output",
                               .example = "aligngs bench --gaussians 50000 --width 320 --height 240",
                               .advanced = "aligngs bench --instructions avx2 --pixel-share 1 --blend logits --json",
                               .notes = "With a CUDA device: aligngs bench --device cuda:0"}));
  auto options = std::make_shared<BenchOptions>();
  StepBenchmarkOptions& steps = options->steps;
  command->add_option("--width", steps.room.width, "width of the picture in pixels")
      ->capture_default_str()
      ->group("Scene");
  command->add_option("--height", steps.room.height, "height of the picture in pixels")
      ->capture_default_str()
      ->group("Scene");
  command->add_option("--gaussians", steps.room.gaussians, "number of Gaussians")
      ->capture_default_str()
      ->group("Scene");
  command->add_option("--channels", steps.room.channels, "number of semantic classes; 0: no semantics")
      ->capture_default_str()
      ->group("Scene");
  const std::map<std::string, bool> orders = {{"morton", true}, {"scattered", false}};
  command
      ->add_option("--order", steps.room.morton_order, "order of the Gaussians in memory: as in training, or scattered")
      ->transform(CLI::CheckedTransformer(orders))
      ->default_str("morton")
      ->group("Scene");
  command
      ->add_option("--pixel-share", steps.pixel_share,
                   "share of the pixels for the semantic loss of a step (semantic.pixel_share)")
      ->check(CLI::IsMember({1.0, 0.5, 0.25}))
      ->capture_default_str()
      ->group("Scene");
  add_choice_option(*command, "--blend", steps.blend, "quantity that the semantic loss blends (semantic.blend)")
      ->group("Scene");
  add_choice_option(*command, "--instructions", options->instructions, "widest vectors to use, without matrix tiles")
      ->group("Machine");
  command->add_option("--steps", steps.steps, "number of timed steps")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str()
      ->group("Machine");
  add_device_option(*command, options->device);
  command->add_flag("--graphs", options->cuda.graphs, "with --device cuda:N: run each step as one CUDA graph")
      ->group("CUDA");
  using Backward = cuda::BlendBackwardMethod;
  const std::map<std::string, Backward> backward = {{"pixel", Backward::kPerPixel}, {"splat", Backward::kPerSplat}};
  command
      ->add_option("--blend-backward", options->cuda.blend_backward,
                   "with --device cuda:N: one thread per pixel, or one lane per splat")
      ->transform(CLI::CheckedTransformer(backward))
      ->default_str("pixel")
      ->group("CUDA");
  using Visit = cuda::SemanticVisitMethod;
  const std::map<std::string, Visit> visit = {
      {"auto", Visit::kAutomatic}, {"compacted", Visit::kCompacted}, {"dense", Visit::kDense}};
  command
      ->add_option("--semantic-visit", options->cuda.semantic_visit,
                   "with --device cuda:N: compacted blocks of 8 x 8 pixels, or dense tiles")
      ->transform(CLI::CheckedTransformer(visit))
      ->default_str("auto")
      ->group("CUDA");
  command->callback([&context, options] {
    options->steps.threads = context.global.threads;
    run_bench(*options, context.global.json);
  });
}

}  // namespace aligngs
