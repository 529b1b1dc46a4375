// `aligngs import SRC -o SCENE`: other layouts become a scene folder.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/number_checks.h"
#include "cli/print_json.h"
#include "core/log.h"
#include "core/shell_word.h"
#include "scene/import/capture_text.h"
#include "scene/import/import_capture.h"

namespace aligngs {
namespace {

struct Options {
  std::string source, output, layout = "auto", intrinsics, train_file, test_file, sfm;
  bool assume_registered = false, trajectory = false, no_depth_prior = false;
  ImportOptions import;
};

std::vector<std::string> names_in(const std::string& file) {
  return file.empty() ? std::vector<std::string>{} : read_name_list(file);
}

void show_warnings(const ImportReport& report, const std::string& scene) {
  constexpr size_t kShown = 3;
  for (size_t i = 0; i < report.warnings.size() && i < kShown; ++i) log_warning("{}", report.warnings[i]);
  if (report.warnings.size() > kShown)
    log_warning("and {} more: `aligngs data check {}` lists them", report.warnings.size() - kShown, quote_word(scene));
}

void run_import(const CommandContext& context, Options& options) {
  CaptureOptions capture_options;
  capture_options.layout = options.layout;
  capture_options.intrinsics = options.intrinsics;
  capture_options.assume_registered = options.assume_registered;
  capture_options.neural_rgbd_trajectory = options.trajectory;
  const Capture capture = read_capture(options.source, capture_options);
  for (const std::string& note : capture.notes) log_warning("{}", note);

  ImportOptions& import = options.import;
  import.train_names = names_in(options.train_file);
  import.test_names = names_in(options.test_file);
  import.depth_prior = !options.no_depth_prior;
  import.sfm = options.sfm;
  import.progress = context.progress();
  import.sources = {options.source};
  ThreadPool pool(context.global.threads);
  const ImportReport report = import_capture(capture, options.output, import, pool);
  warn_left_out(report.train + report.test, report.left_out);
  show_warnings(report, options.output);
  if (context.global.json) {
    nlohmann::json left_out = nlohmann::json::array();
    for (const LeftOut& frame : report.left_out) left_out.push_back({{"name", frame.name}, {"reason", frame.reason}});
    const nlohmann::json document = {
        {"scene", options.output},     {"layout", capture.layout},          {"train", report.train},
        {"test", report.test},         {"skipped", report.left_out.size()}, {"left_out", left_out},
        {"notes", capture.notes},      {"points", report.points},           {"cloud_source", report.cloud_source},
        {"sfm_rmse", report.sfm_rmse}, {"depth_prior", report.depth_prior}, {"warnings", report.warnings}};
    print_json(document);
    return;
  }
  std::printf("%s: %s layout, %zu training and %zu test views, %zu points from %s, depth prior: %s\n",
              options.output.c_str(), capture.layout.c_str(), report.train, report.test, report.points,
              report.cloud_source.c_str(), report.depth_prior ? "sensor" : "none");
  if (report.cloud_source == "sfm")
    std::printf("SfM model aligned on %zu cameras, residual %.4g\n", report.sfm_cameras, report.sfm_rmse);
}

}  // namespace

void add_import_command(CLI::App& program, CommandContext& context) {
  std::vector<std::string> layouts = {"auto"};
  std::string titles, notes = "Layouts, in the order of auto:\n";
  for (const CaptureLayout& layout : capture_layouts()) {
    layouts.push_back(layout.name);
    titles += std::string(titles.empty() ? "" : ", ") + layout.title;
    notes += fmt::format("  {:<11} {}: {}\n", layout.name, layout.title, layout.files);
  }
  notes.pop_back();
  CLI::App* command = program.add_subcommand("import", "Turn a capture with poses into a scene: " + titles);
  command->group("Data");
  command->footer(help_footer(
      {.reads = "a capture with poses; docs/formats.md lists the layouts",
       .writes = "SCENE: a scene folder",
       .example = "aligngs import scans/scene0085_00 -o scene --views 36",
       .advanced =
           "aligngs import capture -o scene --layout rgbd --train train.txt --test test.txt --sfm sparse/0 --strict",
       .notes = notes.c_str()}));
  auto options = std::make_shared<Options>();
  command->add_option("source", options->source, "folder of the capture")->required();
  command->add_option("-o,--output", options->output, "scene folder to write")->required()->group("Output folder");
  command->add_option("--layout", options->layout, "layout of the source")
      ->check(CLI::IsMember(layouts))
      ->capture_default_str()
      ->group("Layout");
  command->add_option("--views", options->import.views, "number of training views to choose, sharp and well spread")
      ->check(positive_number())
      ->group("Frames");
  command->add_option("--stride", options->import.stride, "train on every n-th frame")
      ->check(positive_number())
      ->group("Frames");
  command->add_option("--train", options->train_file, "file with the names of the training frames")->group("Frames");
  command
      ->add_option("--test", options->test_file,
                   "file with the names of the test frames; without --train the others train")
      ->group("Frames");
  command
      ->add_option(
          "--test-views", options->import.test_views,
          "number of test views from the other frames, held out where all would train (default: a third of the "
          "training views)")
      ->check(number_from_zero())
      ->group("Frames");
  command->add_option("--intrinsics", options->intrinsics, "TUM, 7-Scenes: file with the 3x3 camera matrix")
      ->group("Layout");
  command->add_flag("--assume-registered", options->assume_registered, "7-Scenes: use depth as registered to colour")
      ->group("Layout");
  command->add_flag("--tracked-poses", options->trajectory, "Neural RGB-D: use trainval_poses.txt instead of poses.txt")
      ->group("Layout");
  command->add_option("--sfm", options->sfm, "COLMAP model for the cloud; sensor depth is not used then")
      ->group("Points and depth");
  command->add_flag("--no-depth-prior", options->no_depth_prior, "leave sensor depth out of pred_depths/")
      ->group("Points and depth");
  command->add_flag("--neuris-crop", options->import.neuris_crop, "ScanNet: crop and resize to 640x480 as NeuRIS does")
      ->group("Layout");
  command
      ->add_option("--voxel", options->import.voxel,
                   "edge of the cubes that thin the fused cloud, in scene units (default: automatic)")
      ->check(number_from_zero())
      ->group("Points and depth");
  command
      ->add_flag("--strict", options->import.strict,
                 "a frame that cannot be used is an error (status 3); without this it is left out")
      ->group("Frames");
  command->add_flag("--overwrite", options->import.overwrite, "replace a scene that aligngs wrote")
      ->group("Output folder");
  command->callback([&context, options] { run_import(context, *options); });
}

}  // namespace aligngs
