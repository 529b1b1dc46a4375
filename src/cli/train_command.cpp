// `aligngs train SCENE -o RUN`: optimises the Gaussians of a scene.
#include <CLI/App.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/help_text.h"
#include "cli/page_server.h"
#include "cli/print_json.h"
#include "cli/train_options.h"
#include "core/error.h"
#include "train/config_file.h"
#include "train/run_folder.h"

namespace aligngs {
namespace {

void run_train(const CommandContext& context, const std::string& scene, bool print_config,
               const TrainCommandOptions& options) {
  TrainOptions train = train_options(options, context);
  if (print_config) {
    std::fputs(config_to_toml(resolve_config(train.config)).c_str(), stdout);
    return;
  }
  if (options.output.empty()) throw_usage("train needs a run folder: -o RUN");
  if (scene.empty() && !options.resume)
    throw_usage("train needs a scene folder", "for example: aligngs train scene -o run");
  train.scene = scene;
  const RunMode mode = options.overwrite ? RunMode::kOverwrite : options.resume ? RunMode::kResume : RunMode::kNew;
  RunFolder(options.output).check(mode);  // before the page shows a folder that is somebody else's
  if (!scene.empty()) RunFolder(options.output).require_apart_from(scene);
  const auto page = serve_while_working(options.view, options.view_port, options.output, scene, train.threads);
  work_beside_page(page, [&] {
    const TrainResult result = train_run(train);
    if (context.global.json) {
      const nlohmann::json document = {{"run", options.output},           {"already_finished", result.already_finished},
                                       {"iterations", result.iterations}, {"gaussians", result.gaussians},
                                       {"seconds", result.seconds},       {"train_psnr", result.psnr},
                                       {"warnings", result.warnings}};
      print_json(document);
    } else if (result.already_finished) {
      std::printf("%s: finished already (%lld iterations)\n", options.output.c_str(),
                  static_cast<long long>(result.iterations));
    } else {
      std::printf("%s: %lld iterations in %s, %llu Gaussians, training PSNR %.2f dB\n", options.output.c_str(),
                  static_cast<long long>(result.iterations), format_duration(result.seconds).c_str(),
                  static_cast<unsigned long long>(result.gaussians), result.psnr);
    }
    std::fflush(stdout);
  });
}

}  // namespace

void add_train_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("train", "Optimise the Gaussians of a scene");
  command->group("Reconstruct");
  command->footer(help_footer({.reads = "a scene folder",
                               .writes = "RUN: splats, checkpoints, config.toml, events.ndjson",
                               .example = "aligngs train scene -o run --preset preview",
                               .advanced = "aligngs train -o run --resume -n 10000",
                               .notes = "`aligngs run` also renders, meshes and measures."}));
  auto options = std::make_shared<TrainCommandOptions>();
  auto scene = std::make_shared<std::string>();
  auto print_config = std::make_shared<bool>(false);
  command->add_option("scene", *scene, "scene folder (not needed with --resume)");
  command->add_option("-o,--output", options->output, "run folder")->group("Output folder");
  command->add_flag("--print-config", *print_config, "print every setting with its meaning as TOML, and end")
      ->group("Training");
  add_train_options(*command, options);
  command->callback([&context, scene, print_config, options] { run_train(context, *scene, *print_config, *options); });
}

}  // namespace aligngs
