// `aligngs render RUN`: pictures of the run's views.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/stages/render_stage.h"
#include "io/json_text.h"

namespace aligngs {

void add_render_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("render", "Write pictures of the views: colour, depth, normals, labels, error");
  command->group("Measure");
  command->footer(help_footer({.reads = "a run folder and its scene",
                                .writes = "RUN/renders",
                                .example = "aligngs render demo_run",
                                .advanced = "aligngs render demo_run --split all --scene moved/scene"}));
  struct Options {
    std::string run, scene, split = "test", device = "auto";
  };
  auto options = std::make_shared<Options>();
  command->add_option("run", options->run, "run folder")->required();
  command->add_option("--scene", options->scene, "the scene's new place, if it was moved");
  command->add_option("--split", options->split, "which views")->check(CLI::IsMember({"test", "train", "all"}))->capture_default_str();
  add_device_option(*command, options->device);
  command->callback([&context, options] {
    OpenRun run = open_run(options->run, {options->scene, context.global.threads, engine_of_device(options->device)});
    RenderStageOptions stage;
    stage.test = options->split != "train";
    stage.train = options->split != "test";
    stage.progress = context.progress();
    const size_t views = render_views(run, stage);
    const std::string folder = (run.folder / "renders").string();
    if (context.global.json) std::printf("%s\n", json_line(nlohmann::json({{"views", views}, {"folder", folder}})).c_str());
    else std::printf("%zu views in %s\n", views, folder.c_str());
  });
}

}  // namespace aligngs
