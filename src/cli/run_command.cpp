// `aligngs run PHOTOS_OR_SCENE -o RUN`: everything from photos, or from a scene folder, to the report.
#include <CLI/App.hpp>
#include <algorithm>
#include <filesystem>

#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/page_server.h"
#include "cli/photo_options.h"
#include "cli/plan_text.h"
#include "cli/stages/plan_execution.h"
#include "cli/stages/quality_gate.h"
#include "cli/train_options.h"
#include "pipeline/run_plan.h"
#include "pipeline/step_forecast.h"
#include "priors/network_time.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

struct RunCommandOptions {
  TrainCommandOptions train;
  PhotoCommandOptions photos;
  std::string source, depth = "auto", semantics = "auto";
  bool dry_run = false;
  std::vector<std::string> fail_under;
};

RunRequest request_of(const RunCommandOptions& options, const CommandContext& context) {
  RunRequest request;
  request.source = options.source;
  request.train = train_options(options.train, context);
  request.train.resume_command = "aligngs run " + options.source + " -o " + options.train.output + " --resume";
  request.cameras = options.photos;
  request.photos = options.photos.poses;
  request.photos.precision = precision_of(options.photos.precision);
  request.photos.strict = options.train.strict;
  request.priors = {depth_choice(options.depth), semantic_choice(options.semantics)};
  return request;
}

/// With the cameras that the plan chose.
PlanExecutionOptions execution_options(const RunCommandOptions& options, const RunPlan& plan,
                                       const CommandContext& context) {
  PlanExecutionOptions execution;
  execution.precision = precision_of(options.photos.precision);
  put_networks_on(options.train.device, options.photos.precision, false, execution);
  execution.make_fusion_device = fusion_of_device(options.train.device);
  execution.photos = options.photos.poses;
  if (!plan.from_photos()) return execution;
  PhotoCommandOptions photos = options.photos;
  photos.method = plan.cameras.method;
  photos.model = plan.cameras.model;
  photos.memory_gigabytes = options.train.memory_gigabytes;
  execution.photos = photo_options(photos, context);
  execution.photos.strict = options.train.strict;
  if (is_camera_network_method(execution.photos.method))
    put_networks_on(options.train.device, options.photos.precision, false, execution.photos);
  return execution;
}

/// Time of networks where they run on the processor, at a rate that is measured now. Devices stay unknown.
void add_network_time(const RunCommandOptions& options, const CommandContext& context, RunPlan& plan) {
  const auto runs_network = [](const PlannedStep& step) { return step.network && step.outlook != Outlook::kLeftOut; };
  if (std::none_of(plan.steps.begin(), plan.steps.end(), runs_network)) return;
  if (chosen_device(options.train.device, false).cuda) return;
  ThreadPool pool(context.global.threads);
  nn::Compute compute(pool, {precision_of(options.photos.precision), true, true});
  forecast_network_time(measure_network_rate(compute), plan);
}

void run_everything(const RunCommandOptions& options, const CommandContext& context) {
  const std::vector<LeastValue> least = least_values(options.fail_under);
  const RunRequest request = request_of(options, context);
  const ModelStore store = model_store(context);
  RunPlan plan = plan_run(request, store);
  if (options.dry_run) {
    add_network_time(options, context, plan);
    return print_plan(plan, context.global.json);
  }
  const PlanExecutionOptions execution = execution_options(options, plan, context);
  // Served before all long steps. They decide the scene of a new run; its run.json names it once training begins.
  const auto page = serve_while_working(options.train.view, options.train.view_port, plan.run,
                                        plan.begun ? plan.scene : fs::path(), request.train.threads);
  RunMetrics metrics;
  work_beside_page(page, [&] { metrics = execute_plan(plan, request, execution, store, context); });
  require_at_least(metrics, least);
}

}  // namespace

void add_run_command(CLI::App& program, CommandContext& context) {
  CLI::App* command =
      program.add_subcommand("run", "Do everything: poses, priors, training, renders, mesh, figures, report");
  command->group("Reconstruct");
  command->footer(help_footer(
      {.reads = "a folder of photos, a video, or a scene folder",
       .writes =
           "RUN: splats, mesh, renders, metrics.json, report.html; also RUN/scene, if the run makes a scene of its own",
       .example = "aligngs run photos -o run --method colmap --semantics none",
       .advanced =
           "aligngs run scene -o run --preset preview --set densify.max_gaussians=100000 --fail-under psnr=18 --view",
       .notes = "Does everything from photos to the report. Missing poses and priors are made first.\n"
                "The source is never changed. --resume continues after an interruption."}));
  auto train = std::make_shared<TrainCommandOptions>();
  auto photos = std::make_shared<PhotoCommandOptions>();
  auto options = std::make_shared<RunCommandOptions>();
  command
      ->add_option("source", options->source, "folder of photos, a video (needs the program ffmpeg), or a scene folder")
      ->required();
  command->add_option("-o,--output", train->output, "run folder; a scene made of photos is in its scene/")
      ->required()
      ->group("Output folder");
  command
      ->add_option("--semantics", options->semantics,
                   "class priors, if the scene has none: " + words_in_help(semantic_choices()) +
                       ", none, or auto (the first of these that is installed)")
      ->capture_default_str()
      ->group("Priors");
  command
      ->add_option("--depth", options->depth,
                   "depth priors, if the scene has none: " + words_in_help(depth_choices()) +
                       ", none, or auto (the weights of --poses-model; without them depth measured from points, or the "
                       "first of these that is installed)")
      ->capture_default_str()
      ->group("Priors");
  add_refine_options(*command, train);
  add_photo_options(*command, photos);
  add_train_options(*command, train);
  command
      ->add_option("--fail-under", options->fail_under,
                   "name=number; status 6 if the metric is lower (psnr, ssim, fscore, miou)")
      ->group("Checks");
  command
      ->add_flag("--dry-run", options->dry_run,
                 "print the steps with their reasons, memory and time, and change nothing")
      ->group("Checks");
  command->callback([&context, options, train, photos] {
    options->train = *train;
    options->photos = *photos;
    run_everything(*options, context);
  });
}

}  // namespace aligngs
