// `aligngs demo`: a synthetic room through the whole pipeline, the first command that a newcomer types.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/page_server.h"
#include "cli/stages/pipeline.h"
#include "cli/stages/refine_stage.h"
#include "cli/synth_options.h"
#include "cli/train_options.h"
#include "core/error.h"
#include "core/log.h"
#include "scene/scene_place.h"
#include "train/run_folder.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Long enough to show what the method does, short enough for a first try on two cores (the README has the time).
constexpr int64_t kDemoIterations = 600;

/// Below the line "look at" of every run: the room in the browser, and the command for one's own photos.
void print_next_steps(const std::string& run) {
  std::printf("browser      aligngs view %s\n", run.c_str());
  std::printf("your photos  aligngs run PHOTOS -o RUN --method colmap --semantics none (needs the colmap program)\n");
  std::fflush(stdout);
}

void run_demo(const CommandContext& context, const SynthCommandOptions& synth, TrainCommandOptions options) {
  if (options.output.empty()) options.output = "demo_run";
  const fs::path run = options.output, scene = run / "scene";
  const RunMode mode = options.resume ? RunMode::kResume : options.overwrite ? RunMode::kOverwrite : RunMode::kNew;
  RunFolder(run).check(mode);
  if (options.iterations == 0 && options.preset.empty() && options.config_file.empty() && !options.resume)
    options.iterations = kDemoIterations;
  TrainOptions train = train_options(options, context);
  const auto page = serve_while_working(options.view, options.view_port, run, scene, train.threads);
  work_beside_page(page, [&] {
    if (!options.resume || !fs::exists(scene)) {
      log_info("making a synthetic {} with simulated priors", synth.synth.room);
      const bool overwrite = fs::exists(scene);
      require_scene_place(scene, overwrite);
      write_synth_scene(make_scene(synth_options(synth), context), scene, overwrite);
    }
    const bool begun = options.resume && fs::exists(RunFolder(run).record());
    const TrainConfig config = resolve_run(train).config;
    if (!begun && should_refine(scene, config)) refine_into_run(scene, run, config, context);
    train.scene = scene;
    train.resume_command = "aligngs demo -o " + options.output + " --resume";
    run_pipeline(train, context, fusion_of_device(options.device));
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
  command->callback([&context, options, synth] { run_demo(context, *synth, *options); });
}

}  // namespace aligngs
