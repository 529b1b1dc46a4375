// `aligngs bench`: how fast this version trains on this machine, and how far that is from what the machine can do.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "core/memory_budget.h"
#include "engine/benchmark/instruction_limit.h"
#include "engine/benchmark/step_benchmark.h"

namespace aligngs {
namespace {

const std::map<std::string, SemanticBlend> kBlends = {{"probabilities", SemanticBlend::kProbabilities},
                                                      {"logits", SemanticBlend::kLogits}};

std::string name_of(SemanticBlend blend) { return blend == SemanticBlend::kProbabilities ? "probabilities" : "logits"; }

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

nlohmann::json document_of(const StepTiming& timing, const BenchmarkRoom& room, const MachineCeilings& machine) {
  nlohmann::json stages = nlohmann::json::object();
  for (const std::string& stage : stage_names()) {
    if (timing.stages.count(stage) > 0) stages[stage] = stage_json(stage, timing, room, machine);
  }
  const cpu::TileStatistics& t = timing.tiles;
  return {{"version", ALIGNGS_VERSION},
          {"scene",
           {{"width", room.width},
            {"height", room.height},
            {"gaussians", room.gaussians},
            {"channels", room.channels},
            {"pixel_share", timing.pixel_share},
            {"blend", name_of(timing.blend)},
            {"visible", t.visible},
            {"pairs_per_tile", per(t.pairs, t.tiles)},
            {"used_per_tile", per(t.used, t.tiles)},
            {"splats_per_pixel", per(t.active, t.pixels)}}},
          {"machine",
           {{"threads", timing.threads},
            {"instructions", machine.instructions},
            {"fma_gflops", machine.fma_gflops},
            {"amx_gflops", machine.amx_gflops},
            {"read_gbps", machine.read_gbps},
            {"triad_gbps", machine.triad_gbps}}},
          {"step", {{"seconds", timing.seconds}, {"best_seconds", timing.best_seconds},
            {"cpu_seconds", timing.cpu_seconds}, {"stages", stages}}},
          {"densify", densify_json(timing, room, machine)},
          {"render", {{"seconds", timing.render_seconds}}},
          {"peak_memory_bytes", timing.peak_memory_bytes}};
}

void print_table(const nlohmann::json& d) {
  const auto& scene = d["scene"];
  const auto& machine = d["machine"];
  std::printf("scene    %d x %d pixels, %zu Gaussians (%.0f in view, %.0f per tile, %.0f per pixel), %d channels, %s of %.0f %% of the pixels\n",
              scene["width"].get<int>(), scene["height"].get<int>(), scene["gaussians"].get<size_t>(),
              scene["visible"].get<double>(), scene["pairs_per_tile"].get<double>(),
              scene["splats_per_pixel"].get<double>(), scene["channels"].get<int>(),
              scene["blend"].get<std::string>().c_str(), 100 * scene["pixel_share"].get<double>());
  std::printf("machine  %d threads, %s: %.0f GFLOP/s float32", machine["threads"].get<int>(),
              machine["instructions"].get<std::string>().c_str(), machine["fma_gflops"].get<double>());
  if (machine["amx_gflops"].get<double>() > 0) {
    std::printf(", %.2f TFLOP/s bfloat16 tiles", 1e-3 * machine["amx_gflops"].get<double>());
  }
  std::printf(", %.0f GB/s memory\n\n", std::max(machine["read_gbps"].get<double>(), machine["triad_gbps"].get<double>()));
  std::printf("%-14s %9s %9s %9s %8s %9s %9s\n", "stage", "median ms", "best ms", "GFLOP/s", "GB/s", "floor ms", "of floor");
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
  std::printf("%.1f steps per second; densification %.0f ms a call (floor %.0f ms); rendering %.0f ms a view; peak memory %s\n",
              1 / d["step"]["seconds"].get<double>(), 1e3 * d["densify"]["seconds"].get<double>(),
              1e3 * d["densify"]["floor_seconds"].get<double>(),
              1e3 * d["render"]["seconds"].get<double>(),
              format_bytes(d["peak_memory_bytes"].get<uint64_t>()).c_str());
}

}  // namespace

void add_bench_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("bench", "Time training on this machine, stage by stage");
  command->group("Look");
  command->footer("Examples: aligngs bench --gaussians 50000 --width 320 --height 240\n          aligngs bench --instructions avx2");
  auto options = std::make_shared<StepBenchmarkOptions>();
  command->add_option("--width", options->room.width, "pixels")->capture_default_str();
  command->add_option("--height", options->room.height, "pixels")->capture_default_str();
  command->add_option("--gaussians", options->room.gaussians, "Gaussians of the made-up room")->capture_default_str();
  command->add_option("--channels", options->room.channels, "semantic classes, 0 without")->capture_default_str();
  command->add_option("--pixel-share", options->pixel_share, "of the pixels that the semantic loss of a step takes (semantic.pixel_share)")
      ->check(CLI::IsMember({1.0, 0.5, 0.25}))
      ->capture_default_str();
  command->add_option("--blend", options->blend, "what the semantic loss blends (semantic.blend)")
      ->transform(CLI::CheckedTransformer(kBlends, CLI::ignore_case))
      ->default_str("probabilities");
  auto instructions = std::make_shared<Instructions>(Instructions::kAll);
  const std::map<std::string, Instructions> names = {{"all", Instructions::kAll}, {"avx512", Instructions::kAvx512},
                                                     {"avx2", Instructions::kAvx2}, {"sse4", Instructions::kSse4}};
  command->add_option("--instructions", *instructions, "as on a processor with at most these vectors and no matrix tiles")
      ->transform(CLI::CheckedTransformer(names, CLI::ignore_case))
      ->default_str("all");
  command->add_option("--steps", options->steps, "steps that count")->check(CLI::Range(1, 100000))->capture_default_str();
  command->callback([&context, options, instructions] {
    options->threads = context.global.threads;
    options->matrix_tiles = *instructions == Instructions::kAll;
    const InstructionLimit limit(*instructions);
    const StepTiming timing = time_steps(*options);
    ThreadPool pool(options->threads);
    const nlohmann::json document = document_of(timing, options->room, measure_ceilings(pool, options->matrix_tiles));
    if (context.global.json) {
      std::printf("%s\n", document.dump(2).c_str());
    } else {
      print_table(document);
    }
  });
}

}  // namespace aligngs
