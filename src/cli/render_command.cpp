// `aligngs render RUN`: pictures of the run's views, and of a camera that goes through the room.
#include <CLI/App.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/number_checks.h"
#include "cli/print_json.h"
#include "cli/stages/path_stage.h"
#include "cli/stages/render_stage.h"
#include "core/error.h"
#include "core/log.h"
#include "edit/edit_session.h"
#include "io/output_place.h"
#include "train/run_folder.h"

namespace aligngs {
namespace {

constexpr double kFewestFrames = 1, kMostFrames = 240;  // a second
constexpr double kShortest = 0.1, kLongest = 3600;      // seconds of a way

struct RenderCommandOptions {
  std::string run, scene, split, device = "auto";
  std::string path, view, output, size = "1280x720";
  double frames_per_second = 30, seconds = 0, at = 0;
  bool original = false;
};

LoadedRun opened(const CommandContext& context, const RenderCommandOptions& options) {
  return load_run(options.run, {options.scene, context.global.threads, engine_of_device(options.device)});
}

/// With the edits of the run, as the page shows it.
LoadedRun opened_as_edited(const CommandContext& context, const RenderCommandOptions& options) {
  LoadedRun run = opened(context, options);
  if (options.original || !std::filesystem::exists(run.folder() / "edits.json")) return run;
  const EditSession session(run.opened, {{}, context.global.threads});
  if (session.stack().empty()) return run;
  run.model = session.room().gaussians.model;
  run.engine->load(run.model);
  return run;
}

void draw_views(const CommandContext& context, const RenderCommandOptions& options) {
  LoadedRun run = opened(context, options);
  RenderStageOptions stage;
  stage.split = options.split == "test"    ? RenderedSplit::kTest
                : options.split == "train" ? RenderedSplit::kTrain
                : options.split == "all"   ? RenderedSplit::kAll
                                           : RenderedSplit::kPictured;
  stage.progress = context.progress();
  const size_t views = render_views(run, stage);
  const std::string folder = (run.folder() / "renders").string();
  if (context.global.json)
    print_json(nlohmann::json{{"views", views}, {"folder", folder}});
  else
    std::printf("%zu views in %s\n", views, folder.c_str());
}

void draw_path(const CommandContext& context, const RenderCommandOptions& options) {
  PathStageOptions stage;
  stage.path = options.path;
  const bool tour = options.path == "orbit" || options.path == "walk";
  stage.output = options.output.empty() ? std::filesystem::path(options.run) / ((tour ? options.path : "path") + ".mp4")
                                        : std::filesystem::path(options.output);
  stage.size = parse_picture_size(options.size);
  stage.frames_per_second = options.frames_per_second;
  if (options.seconds > 0) stage.seconds = options.seconds;
  stage.at = options.at;
  stage.progress = context.progress();
  require_path_place(options.run, stage);
  LoadedRun run = opened_as_edited(context, options);
  const PathPictures made = render_path(run, stage);
  const std::string place = made.output.string();
  if (made.video_missing) {
    log_warning(
        "ffmpeg is not installed: the pictures are in a folder. Where it is, make the video with\n  "
        "ffmpeg -framerate {} -i '{}/frame_%05d.png' -pix_fmt yuv420p '{}'",
        options.frames_per_second, place, stage.output.string());
  }
  if (context.global.json)
    print_json(nlohmann::json{{"pictures", made.frames},
                              {"seconds", made.seconds},
                              {"output", place},
                              {"video_missing", made.video_missing}});
  else
    std::printf("%zu picture%s in %s\n", made.frames, made.frames == 1 ? "" : "s", place.c_str());
}

void draw_view(const CommandContext& context, const RenderCommandOptions& options) {
  const std::string file = options.output.empty() ? options.view + ".png" : options.output;
  require_output_file(file);
  require_extension(file, "png");
  RunFolder(options.run).require_not_of_run(file, options.scene);
  const PictureSize size = parse_picture_size(options.size);
  LoadedRun run = opened_as_edited(context, options);
  render_view_picture(run, options.view, size, file);
  if (context.global.json)
    print_json(nlohmann::json{{"pictures", 1}, {"output", file}});
  else
    std::printf("%s\n", file.c_str());
}

}  // namespace

void add_render_command(CLI::App& program, CommandContext& context) {
  CLI::App* command =
      program.add_subcommand("render", "Write pictures of the views, a video through the room, or one picture");
  command->group("Measure");
  command->footer(
      help_footer({.reads = "a run folder and its scene",
                   .writes = "RUN/renders; with --path a video or pictures, with --view one picture",
                   .example = "aligngs render demo_run",
                   .advanced = "aligngs render demo_run --path walk --size 1920x1080 -o walk.mp4",
                   .notes = "The page saves key frames as a file for --path. Orbit and walk stay inside the room.\n"
                            "A video needs ffmpeg. Without it the pictures are written."}));
  auto options = std::make_shared<RenderCommandOptions>();
  command->add_option("run", options->run, "run folder")->required();
  command->add_option("--scene", options->scene, "the scene's new place, if it was moved");
  CLI::Option* split =
      command
          ->add_option("--split", options->split, "which views: default test, or four of train without any test view")
          ->check(CLI::IsMember({"test", "train", "all"}));
  CLI::Option* path =
      command->add_option("--path", options->path, "orbit, walk, or a file of key frames")->group("Camera");
  CLI::Option* view =
      command->add_option("--view", options->view, "one picture from the place of this photo")->group("Camera");
  path->excludes(split)->excludes(view);
  view->excludes(split);
  CLI::Option* output =
      command
          ->add_option("-o,--output", options->output,
                       "FILE.mp4, FILE.png or a folder (default: RUN/orbit.mp4, RUN/walk.mp4, RUN/path.mp4 for a file "
                       "of key frames; with --view NAME.png in this folder)")
          ->group("Camera");
  CLI::Option* size =
      command->add_option("--size", options->size, "pixels, WIDTHxHEIGHT")->capture_default_str()->group("Camera");
  CLI::Option* rate = command->add_option("--fps", options->frames_per_second, "pictures a second")
                          ->check(CLI::Range(kFewestFrames, kMostFrames))
                          ->capture_default_str()
                          ->group("Camera");
  CLI::Option* seconds =
      command->add_option("--seconds", options->seconds, "of the whole way (default: 16, or as the file says)")
          ->check(CLI::Range(kShortest, kLongest))
          ->group("Camera");
  CLI::Option* at = command->add_option("--at", options->at, "with -o FILE.png: seconds from the begin")
                        ->check(number_from_zero())
                        ->group("Camera");
  CLI::Option* original =
      command->add_flag("--original", options->original, "the room before its edits")->group("Camera");
  for (CLI::Option* option : {rate, seconds, at}) option->needs(path);
  at->needs(output);
  add_device_option(*command, options->device);
  command->callback([&context, options, output, size, original, rate, at] {
    const bool picture = std::filesystem::path(options->output).extension() == ".png";
    if (at->count() > 0 && !picture)
      throw_usage("--at is the time of one picture", "name a picture with -o FILE.png, or leave --at out");
    if (rate->count() > 0 && picture)
      throw_usage("--fps is for a video or many pictures", "leave --fps out, or name FILE.mp4 or a folder with -o");
    if (!options->path.empty()) return draw_path(context, *options);
    if (!options->view.empty()) return draw_view(context, *options);
    if (output->count() + size->count() + original->count() > 0) {
      throw_usage("-o, --size and --original belong to --path or --view",
                  "the pictures of the views go to RUN/renders, at the size of the photos");
    }
    draw_views(context, *options);
  });
}

}  // namespace aligngs
