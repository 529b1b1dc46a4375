// `aligngs synth OUT`: a procedural room with exact truth and simulated teachers, and how those teachers compare with
// real networks.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/help_text.h"
#include "cli/number_checks.h"
#include "cli/print_json.h"
#include "cli/synth_options.h"
#include "core/log.h"
#include "mesh/fusion.h"
#include "metrics/mesh_protocols.h"
#include "scene/scene_place.h"
#include "synth/acceptance.h"
#include "synth/removal_truth.h"

namespace aligngs {
namespace {

/// F-score of the TSDF of the teacher's depth with the teacher's poses: what a feed-forward network alone would score.
AcceptanceFigure tsdf_figure(const SynthScene& scene, ThreadPool& pool) {
  std::vector<FusionFrame> frames;
  MeshEvaluationInput input;
  for (const int index : scene.train) {
    const SynthView& view = scene.views[index];
    FusionFrame frame;
    frame.name = view.name;
    frame.camera = view.teacher.camera;
    frame.depth = view.teacher.depth;
    frames.push_back(std::move(frame));
  }
  for (const SynthView& view : scene.views) {
    input.run_cameras.push_back(view.teacher.camera);
    input.truth_cameras.push_back(view.truth.camera);
  }
  FusionOptions options;
  options.min_cosine = 0.17;          // 80 degrees
  options.single_view_weight = 0.25;  // of surface that one view alone sees
  options.consistency.depth_tolerance = 0.01;
  options.metric = !scene.options.unknown_similarity;
  const FusionResult fused = fuse_depth(frames, options, pool);
  input.predicted = &fused.mesh;
  input.truth = &scene.mesh;
  input.train = scene.train;
  const MeshProtocolResult result = evaluate_neuris_vertices(input, CullingViews::kAll, MeshAlignment::kCameras, pool);
  AcceptanceFigure figure;
  figure.name = "TSDF F-score at 5 cm";
  figure.value = result.scores.fscore;
  if (scene.options.teacher == TeacherKind::kSimulated && scene.options.level == TeacherLevel::kMedium &&
      scene.options.depth_teacher != DepthTeacher::kSensor) {
    figure.low = 0.55;  // meshes fused from published networks' depth lie between
    figure.high = 0.75;
  }
  return figure;
}

nlohmann::json to_json(const AcceptanceReport& report) {
  nlohmann::json figures = nlohmann::json::array();
  for (const AcceptanceFigure& f : report.figures) {
    figures.push_back({{"name", f.name},
                       {"value", f.value},
                       {"unit", f.unit},
                       {"low", f.low ? nlohmann::json(*f.low) : nlohmann::json()},
                       {"high", f.high ? nlohmann::json(*f.high) : nlohmann::json()},
                       {"accepted", f.accepted()}});
  }
  return {{"teacher", report.teacher},
          {"accepted", report.accepted()},
          {"figures", figures},
          {"published", report.published ? nlohmann::json{{"network", report.published->network},
                                                          {"auc_30", report.published->auc_30},
                                                          {"abs_rel", report.published->abs_rel}}
                                         : nlohmann::json()},
          {"published_panoptic_quality",
           report.published_panoptic_quality ? nlohmann::json(*report.published_panoptic_quality) : nlohmann::json()},
          {"not_measured", "PSNR lost by training with the teacher's poses (needs two trainings)"}};
}

}  // namespace

void add_synth_command(CLI::App& program, CommandContext& context) {
  CLI::App* command =
      program.add_subcommand("synth", "Make a synthetic furnished room with exact truth and simulated priors");
  command->group("Data");
  command->footer(help_footer(
      {.reads = "nothing",
       .writes = "a scene folder with simulated priors and truth/",
       .example = "aligngs synth room --room kitchen --views 36",
       .advanced = "aligngs synth room --teacher-seed 2 --level high --labels shuffled --unknown-similarity",
       .notes = "The command prints how the simulated priors compare with real networks."}));
  auto options = std::make_shared<SynthCommandOptions>();
  auto output = std::make_shared<std::string>();
  auto overwrite = std::make_shared<bool>(false);
  command->add_option("output", *output, "scene folder to write")->required();
  command->add_flag("--overwrite", *overwrite, "replace a scene that aligngs wrote")->group("Output folder");
  add_synth_options(*command, options);
  auto without = std::make_shared<std::vector<std::string>>();
  command
      ->add_option("--without", *without,
                   "also write the truth of the room without these objects, e.g. \"bed#1\"; repeatable")
      ->group("Room");
  command->add_option("--seed", options->synth.seed, "the same as --room-seed")->check(seed_number())->group("Room");
  command->callback([&context, options, output, overwrite, without] {
    require_scene_place(*output, *overwrite);
    const SynthOptions synth = synth_options(*options);
    // Before the pictures are made, which takes a while: a name that the room has not.
    const RoomModel room = build_room({synth.room, synth.seed, synth.glossy, synth.strong_gloss});
    for (const std::string& text : *without) parse_removal(room, text);
    const SynthScene scene = make_scene(synth, context);
    ThreadPool pool(context.global.threads);
    std::vector<RemovalTruth> removals;
    for (const std::string& text : *without)
      removals.push_back(make_removal_truth(scene, parse_removal(scene.room, text), pool));
    AcceptanceReport report = measure_acceptance(scene, pool);
    report.figures.push_back(tsdf_figure(scene, pool));
    write_synth_scene(scene, *output, *overwrite, removals);  // last: who stops the command has what was there before
    if (context.global.json) {
      const nlohmann::json document = {{"scene", *output},
                                       {"train", scene.train.size()},
                                       {"test", scene.test.size()},
                                       {"acceptance", to_json(report)}};
      print_json(document);
      return;
    }
    std::printf("%s: %zu training and %zu test views; priors: %s\n\n%s", output->c_str(), scene.train.size(),
                scene.test.size(), report.teacher.c_str(), report.table().c_str());
    std::printf("not measured here: PSNR lost by training with the teacher's poses (needs two trainings)\n");
  });
}

}  // namespace aligngs
