// `aligngs run PHOTOS_OR_SCENE -o RUN`: everything from photos, or from a scene folder, to the report.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/page_server.h"
#include "cli/photo_options.h"
#include "cli/stages/eval_stage.h"
#include "cli/stages/pipeline.h"
#include "cli/stages/refine_stage.h"
#include "cli/train_options.h"
#include "core/error.h"
#include "core/log.h"
#include "core/shell_word.h"
#include "io/colmap.h"
#include "io/output_place.h"
#include "priors/video_frames.h"
#include "refine/scene_copy.h"
#include "scene/import/capture.h"
#include "train/run_folder.h"
#include "train/run_record.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

struct RunCommandOptions {
  TrainCommandOptions train;
  PhotoCommandOptions photos;
  std::string source, semantics = "auto", depth = "auto";
  std::vector<std::string> fail_under;
};

bool is_network(const PhotoCommandOptions& photos) { return photos.method != "colmap" && photos.method != "given"; }

/// Weights that were asked for by name must be there before anything else starts.
void require_weights(const ModelStore& store, RunCommandOptions& options, bool photos) {
  try {
    if (photos) choose_method(options.photos, store);
    if (photos && is_network(options.photos)) store.require(published_model(poses_model(options.photos)));
    if (options.semantics != "auto" && options.semantics != "none") store.require(semantic_model(options.semantics));
    if (options.depth != "auto" && options.depth != "none") store.require(depth_model(options.depth));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kWeights || !photos) throw;
    Error::Details details = error.details();
    details.remedy += fmt::format(
        "\n  or go without networks (no class labels): aligngs run {} -o {} --method colmap --semantics none",
        quote_word(options.source), quote_word(options.train.output));
    throw Error(details);
  }
}

/// The networks that fill what a scene lacks; null where nothing is to be filled.
struct MissingPriors {
  const PublishedModel* depth = nullptr;
  const PublishedModel* semantics = nullptr;
  bool any() const { return depth || semantics; }
};

/// Missing priors that installed weights can fill; reports what stays empty and how to change that.
/// Depth that a run can measure in the photos is not left to networks that see one photo at a time.
MissingPriors missing_priors(const fs::path& folder, const ModelStore& store, const RunCommandOptions& options,
                             const TrainConfig& config) {
  const Scene scene = open_scene(folder);
  MissingPriors missing;
  if (options.depth != "none" && !scene.has_prior_depth()) {
    if (options.depth != "auto")
      missing.depth = &depth_model(options.depth);
    else if (const PublishedModel* model = installed_camera_network(options.photos, store))
      missing.depth = model;
    else if (!should_measure(folder, config))
      missing.depth = installed_depth_model(store);
    const bool unnamed = options.depth == "auto" && options.photos.model.empty() && options.photos.method != "vggt";
    if (unnamed && missing.depth) warn_of_terms(*missing.depth, "depth");
  }
  if (options.semantics != "none" && !scene.has_semantics()) {
    missing.semantics =
        options.semantics != "auto" ? &semantic_model(options.semantics) : installed_semantic_model(store);
    if (!missing.semantics)
      log_info(
          "no class labels: no weights for them are here (aligngs models download eomt-l, 1.3 GB, or lingbot-s, 0.1 "
          "GB)");
  }
  return missing;
}

void fill_priors(const fs::path& folder, const MissingPriors& missing, const ModelStore& store,
                 const RunCommandOptions& options, const CommandContext& context) {
  ScenePriorsOptions fill;
  fill.precision = precision_of(options.photos.precision);
  put_networks_on(options.train.device, options.photos.precision, false, fill);
  fill.drop_percent = options.photos.poses.drop_percent;
  fill.memory_limit = static_cast<uint64_t>(options.train.memory_gigabytes * 1e9);
  fill.threads = context.global.threads;
  fill.progress = context.progress();
  if (missing.depth) fill_depth(folder, store, *missing.depth, fill);
  if (missing.semantics) fill_semantics(folder, store, *missing.semantics, fill);
}

/// A scene is never changed: what this run makes of it goes to RUN/scene, which is therefore no source.
void require_source_apart(const fs::path& source, const RunFolder& run, bool begun) {
  run.require_apart_from(source);
  if (begun || !lies_within(source, run.path() / "scene")) return;
  throw Error({ErrorKind::kUsage, "the source is where the run keeps a scene of its own", source, "source",
               "name another run folder, or train on it as it is: aligngs train " + source.string() + " -o " +
                   run.path().string()});
}

nlohmann::json run_everything(const RunCommandOptions& given, const CommandContext& context) {
  RunCommandOptions options = given;
  const fs::path source = options.source, run = options.train.output;
  TrainOptions train = train_options(options.train, context);
  train.resume_command = "aligngs run " + options.source + " -o " + options.train.output + " --resume";
  const bool video = fs::is_regular_file(source) && is_video_name(source);
  if (!video && fs::is_regular_file(source))
    throw_bad_input(source, "", "this is neither a folder nor a video",
                    "give a folder of photos, a video, or a scene folder");
  if (!video && !fs::is_directory(source))
    throw_bad_input(source, "", "there is no such folder", "give a folder of photos, a video, or a scene folder");
  const bool photos = video || options.photos.method == "given" || !may_hold_colmap_model(source);
  if (photos && is_network(options.photos) && fs::exists(source / "transforms.json")) {
    throw_bad_input(source, "transforms.json", "this is a nerfstudio data set, whose cameras are in transforms.json",
                    fmt::format("use them: aligngs run {0} -o {1} --method given\n  or, with depth and its own split: "
                                "aligngs import {0} -o SCENE, then aligngs run SCENE -o {1}",
                                options.source, options.train.output));
  }
  if (photos && !video && is_network(options.photos) && (may_hold_polycam(source) || may_hold_scanner_app(source))) {
    throw_bad_input(source, "", "this is a telephone's capture, which has cameras and depth of its own",
                    fmt::format("use them: aligngs import {0} -o SCENE, then aligngs run SCENE -o {1}", options.source,
                                options.train.output));
  }
  if (photos && !video && !has_photos(source)) {
    throw_bad_input(source, "", "neither a scene (no sparse/) nor photos (no JPEG, PNG, WebP or HEIC) are here",
                    "give a folder of photos; a posed capture becomes a scene with `aligngs import`");
  }
  const RunMode mode = options.train.resume      ? RunMode::kResume
                       : options.train.overwrite ? RunMode::kOverwrite
                                                 : RunMode::kNew;
  RunFolder(run).check(mode);
  const ModelStore store = model_store(context);
  const fs::path own = run / "scene";
  fs::path basis = source;  // the scene that is refined or measured
  const bool begun = options.train.resume && fs::exists(RunFolder(run).record());
  require_source_apart(source, RunFolder(run), begun);
  const TrainConfig config = resolve_run(train).config;
  if (!begun) require_weights(store, options, photos);
  const bool has_own = photos || (begun && read_run_record(RunFolder(run).record()).scene == own.filename());
  fs::path scene = has_own ? own : source;
  // Served before all long steps. They decide the scene of a new run; its run.json names it once training begins.
  const auto page =
      serve_while_working(options.train.view, options.train.view_port, run, begun ? scene : fs::path(), train.threads);
  nlohmann::json metrics;
  work_beside_page(page, [&] {
    if (!begun && !photos) {
      if (const MissingPriors missing = missing_priors(source, store, options, config); missing.any()) {
        write_scene_copy(source, own, true);
        basis = scene = own;
        fill_priors(own, missing, store, options, context);
      }
    }
    bool refine = !begun && !photos && should_refine(basis, config);
    const bool measured =
        !begun && !photos && should_measure(basis, config) && measure_into_run(basis, run, config, context);
    const bool completed = !begun && !photos && !refine && !measured && should_complete(basis, config) &&
                           complete_into_run(basis, run, config, context);
    if (refine || measured || completed) scene = own;
    if (photos && !(begun && may_hold_colmap_model(scene))) {
      options.photos.memory_gigabytes = options.train.memory_gigabytes;
      ScenePhotosOptions poses = photo_options(options.photos, context);
      if (uses_network(poses.method)) put_networks_on(options.train.device, options.photos.precision, false, poses);
      poses.overwrite = fs::exists(scene);
      poses.strict = options.train.strict;
      fs::create_directories(run);
      const ScenePhotosReport report = run_poses(options.source, scene.string(), poses, store);
      log_info("{} of {} photos placed by {}, {} points", report.placed, report.photos, report.method, report.points);
      fill_priors(scene, missing_priors(scene, store, options, config), store, options, context);
      if (should_measure(scene, config)) measure_into_run(scene, run, config, context);
      refine = should_refine(scene, config);
      if (!refine && should_complete(scene, config)) complete_into_run(scene, run, config, context);
    }
    if (refine) refine_into_run(photos ? scene : basis, run, config, context);
    train.scene = scene;
    metrics = run_pipeline(train, context, fusion_of_device(options.train.device));
  });
  return metrics;
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
           "aligngs run scene -o run --preset preview --set train.max_gaussians=100000 --fail-under psnr=18 --view",
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
  command->callback([&context, options, train, photos] {
    options->train = *train;
    options->photos = *photos;
    const std::vector<LeastValue> least = least_values(options->fail_under);
    require_at_least(run_everything(*options, context), least);
  });
}

}  // namespace aligngs
