// `aligngs eval RUN`: measures and writes metrics.json.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "cli/stages/eval_stage.h"
#include "cli/stages/quality_gate.h"
#include "cli/summary.h"
#include "core/error.h"
#include "metrics/metrics_json.h"

namespace aligngs {

void add_eval_command(CLI::App& program, CommandContext& context) {
  CLI::App* command =
      program.add_subcommand("eval", "Measure a run against its test views and truth, write metrics.json");
  command->group("Measure");
  command->footer(
      help_footer({.reads = "a run folder and its scene, with test views and truth/",
                   .writes = "RUN/metrics.json; with --mesh nothing, the figures are printed",
                   .example = "aligngs eval demo_run",
                   .advanced = "aligngs eval demo_run --mesh other.ply --no-views --icp --fail-under fscore=0.9",
                   .notes = "mIoU counts classes with at least 0.1 % of the labelled pixels. A second figure counts "
                            "all classes present."}));
  struct Options {
    std::string run, scene, truth, mesh, device = "auto";
    bool icp = false, no_pose_fit = false, no_views = false;
    std::vector<std::string> fail_under;
  };
  auto options = std::make_shared<Options>();
  command->add_option("run", options->run, "run folder")->required();
  command->add_option("--scene", options->scene, "the scene's new place, if it was moved");
  command->add_option("--gt-mesh", options->truth, "true mesh (default: truth/mesh.ply of the scene)")
      ->group("Geometry");
  command
      ->add_option("--mesh", options->mesh, "measure this mesh instead of mesh/mesh.ply, without writing metrics.json")
      ->group("Geometry");
  command
      ->add_flag("--icp", options->icp,
                 "add variants aligned by ICP (for diagnosis: ICP hides errors of scale and bend)")
      ->group("Geometry");
  command
      ->add_flag("--no-pose-fit", options->no_pose_fit, "leave out the scores with each test photo's pose fitted to it")
      ->group("Pictures");
  command->add_flag("--no-views", options->no_views, "measure the mesh alone (with --mesh)")->group("Geometry");
  command
      ->add_option("--fail-under", options->fail_under,
                   "name=number; status 6 if the metric is lower (psnr, ssim, fscore, miou)")
      ->group("Checks");
  add_device_option(*command, options->device);
  command->callback([&context, options] {
    const std::vector<LeastValue> least = least_values(options->fail_under);
    EvalStageOptions stage;
    stage.truth_mesh = options->truth;
    stage.mesh = options->mesh;
    stage.icp = options->icp;
    if (options->no_views && options->mesh.empty())
      throw_usage("--no-views would leave metrics.json without its views", "give --mesh as well");
    stage.views = !options->no_views;
    stage.refine_test_poses = !options->no_pose_fit;
    stage.progress = context.progress();
    require_named_meshes(stage);
    LoadedRun run = load_run(options->run, {options->scene, context.global.threads, engine_of_device(options->device)});
    const RunMetrics metrics = evaluate_run(run, stage);
    if (context.global.json)
      print_json(metrics_json(metrics));
    else
      std::fputs(metrics_summary(metrics).c_str(), stdout);
    require_at_least(metrics, least);
  });
}

}  // namespace aligngs
