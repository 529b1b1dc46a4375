// `aligngs demo`: a synthetic room through the whole pipeline, the first command that a newcomer types.
#include <CLI/App.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/page_server.h"
#include "cli/photo_options.h"
#include "cli/plan_text.h"
#include "cli/stages/plan_execution.h"
#include "cli/synth_options.h"
#include "cli/train_options.h"
#include "core/log.h"
#include "pipeline/run_plan.h"
#include "scene/scene_place.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Long enough to show what the method does, short enough for a first try on two cores (the README has the time).
constexpr int64_t kDemoIterations = 600;

/// Below the line "look at" of every run: the room in the browser, and the command for one's own photos.
void print_next_steps(const std::string& run) {
  std::printf("your photos  aligngs run PHOTOS -o RUN --method colmap --semantics none (needs the colmap program)\n");
  std::fflush(stdout);
}

void run_demo(const CommandContext& context, const SynthCommandOptions& synth, TrainCommandOptions options,
              bool dry_run) {
  if (options.output.empty()) options.output = "demo_run";
  if (options.iterations == 0 && options.preset.empty() && options.config_file.empty() && !options.resume)
    options.iterations = kDemoIterations;
  RunRequest request;
  request.train = train_options(options, context);
  request.train.resume_command = "aligngs demo -o " + options.output + " --resume";
  const SynthOptions room = synth_options(synth);
  const uint64_t pixels = uint64_t(room.width) * uint64_t(room.height) * uint64_t(room.views);
  const RunPlan plan = plan_demo(request.train, room.room, pixels);
  if (dry_run) return print_plan(plan, context.global.json);
  const fs::path scene = plan.own_scene();
  PlanExecutionOptions execution;
  execution.make_fusion_device = fusion_of_device(options.device);
  execution.synth = [&] {
    log_info("making a synthetic {} with simulated priors", room.room);
    const bool overwrite = fs::exists(scene);
    require_scene_place(scene, overwrite);
    write_synth_scene(make_scene(room, context), scene, overwrite);
  };
  const auto page = serve_while_working(options.view, options.view_port, plan.run, scene, request.train.threads);
  work_beside_page(page, [&] {
    execute_plan(plan, request, execution, model_store(context), context);
    if (!context.global.json) print_next_steps(options.output);
  });
}

}  // namespace

void add_demo_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("demo", "Reconstruct a synthetic room: start here");
  command->group("Reconstruct");
  command->footer(
      help_footer({.reads = "nothing",
                   .writes = "demo_run: a synthetic scene in scene/, splats, mesh, renders, metrics.json, report.html",
                   .example = "aligngs demo",
                   .advanced = "aligngs demo --room kitchen --views 36 -o kitchen_run --view",
                   .notes = "The priors of the room are simulated."}));
  auto options = std::make_shared<TrainCommandOptions>();
  auto synth = std::make_shared<SynthCommandOptions>();
  command->add_option("-o,--output", options->output, "run folder (default demo_run); the scene is in its scene/")
      ->group("Output folder");
  add_train_options(*command, options);
  add_refine_options(*command, options);
  add_synth_options(*command, synth);
  auto dry_run = std::make_shared<bool>(false);
  command->add_flag("--dry-run", *dry_run, "print the steps with their reasons, memory and time, and change nothing")
      ->group("Checks");
  command->callback([&context, options, synth, dry_run] { run_demo(context, *synth, *options, *dry_run); });
}

}  // namespace aligngs
