// `aligngs run SCENE -o RUN`: everything from a scene folder to the report.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/page_server.h"
#include "cli/stages/eval_stage.h"
#include "cli/stages/pipeline.h"
#include "cli/train_options.h"
#include "core/error.h"
#include "train/run_folder.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// A folder of photos without cameras cannot be reconstructed by this version: say so before anything else.
void require_scene(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw_bad_input(folder, "", "there is no such folder", "give a scene folder");
  for (const char* name : {"sparse", "cameras.bin", "cameras.txt"}) {
    if (fs::exists(folder / name)) return;
  }
  throw_bad_input(folder, "sparse/", "there are no camera poses here, and this version cannot find them itself",
                  "import a posed capture (`aligngs import`), or run COLMAP and put its model into sparse/ beside images/");
}

}  // namespace

void add_run_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("run", "Everything: train, render, mesh, measure, report");
  command->group("Reconstruct");
  command->footer("Example: aligngs run scene -o run\n         aligngs run scene -o run --preset preview --fail-under psnr=18");
  auto options = std::make_shared<TrainCommandOptions>();
  auto scene = std::make_shared<std::string>();
  auto fail_under = std::make_shared<std::vector<std::string>>();
  command->add_option("scene", *scene, "scene folder")->required();
  command->add_option("-o,--output", options->output, "run folder")->required();
  add_train_options(*command, options);
  command->add_option("--fail-under", *fail_under, "name=number; status 6 when the metric is below (psnr, ssim, fscore, miou)");
  command->callback([&context, scene, options, fail_under] {
    TrainOptions train = train_options(*options, context);
    require_scene(*scene);
    train.scene = *scene;
    train.resume_command = "aligngs run " + *scene + " -o " + options->output + " --resume";
    const RunMode mode = options->overwrite ? RunMode::kOverwrite : options->resume ? RunMode::kResume : RunMode::kNew;
    RunFolder(options->output).check(mode);
    const auto page = serve_while_working(options->view, options->view_port, options->output, train.scene, train.threads);
    const nlohmann::json metrics = run_pipeline(train, context);
    go_on_serving(page);
    require_at_least(metrics, *fail_under);
  });
}

}  // namespace aligngs
