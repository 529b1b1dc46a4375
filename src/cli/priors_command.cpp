// `aligngs priors SCENE`: depth and classes of the training views by networks.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/number_checks.h"
#include "cli/photo_options.h"
#include "cli/print_json.h"
#include "core/error.h"
#include "core/log.h"
#include "io/folder_replacement.h"
#include "priors/teacher_list.h"
#include "refine/scene_copy.h"
#include "scene/scene_place.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

struct PriorsOptions {
  std::string scene, output, depth = "auto", semantics = "auto", precision = "auto", device = "auto";
  double memory_gigabytes = 0;
  ScenePriorsOptions fill;
};

nlohmann::json json_of(const ScenePriorsReport& report) {
  return {{"model", report.model},
          {"views", report.written},
          {"was_there", report.was_there},
          {"width", report.width},
          {"height", report.height},
          {"segments", report.makes_segments ? nlohmann::json(report.segments) : nlohmann::json()}};
}

std::string line_of(const ScenePriorsReport& report) {
  if (report.was_there) return report.model + ", was there already";
  std::string line =
      fmt::format("{}, {} views, maps of {} x {}", report.model, report.written, report.width, report.height);
  if (report.makes_segments) line += fmt::format(", {} segments", report.segments);
  return line;
}

/// Priors are filled in a scene that this program wrote, or in a copy of it.
void require_place(const PriorsOptions& options) {
  if (!options.output.empty()) return require_scene_place(options.output, options.fill.overwrite, {options.scene});
  if (!fs::is_directory(options.scene) || is_own_scene(options.scene)) return;  // opening reports non-folders
  throw Error({ErrorKind::kUsage, "aligngs did not write this folder, as its scene.json shows, so it is not changed",
               options.scene, "scene", "name a folder for a copy with the priors: -o OUT"});
}

void run_priors(const CommandContext& context, PriorsOptions& options) {
  require_place(options);
  options.fill.precision = precision_of(options.precision);
  put_networks_on(options.device, options.precision, true, options.fill);
  const ModelStore store = model_store(context);
  const Scene scene = open_scene(options.scene);
  // Everything that is asked for must be there before the first network runs.
  const PublishedModel* depth = nullptr;
  const PublishedModel* semantics = nullptr;
  const PriorChoice depth_asked = depth_choice(options.depth), semantics_asked = semantic_choice(options.semantics);
  if (depth_asked.automatic()) {
    if (!scene.has_prior_depth()) depth = installed_depth_model(store);
    if (depth) warn_of_terms(*depth, "depth");
  } else if (depth_asked.network) {
    depth = &published_model(depth_asked.network->model);
    store.require(*depth);
  }
  if (semantics_asked.automatic()) {
    if (!scene.has_semantics()) semantics = installed_semantic_model(store);
  } else if (semantics_asked.network) {
    semantics = &published_model(semantics_asked.network->model);
    store.require(*semantics);
  }
  const bool nothing_asked = depth_asked.automatic() && semantics_asked.automatic();
  if (nothing_asked && !depth && !semantics && !(scene.has_prior_depth() && scene.has_semantics())) {
    const PublishedModel& light = *suggested_semantic_models().back();
    throw Error({ErrorKind::kWeights, "no weights for depth or classes are on this machine", options.scene, "",
                 how_to_get(store, light)});
  }
  std::optional<FolderReplacement> copy;  // which appears with its priors, or not at all
  const std::string shown = options.output.empty() ? options.scene : options.output;
  if (!options.output.empty()) {
    copy.emplace(options.output);
    write_scene_copy(options.scene, copy->path(), false);
    options.scene = copy->path().string();
  }
  options.fill.memory_limit = static_cast<uint64_t>(options.memory_gigabytes * 1e9);
  options.fill.threads = context.global.threads;
  options.fill.progress = context.progress();
  nlohmann::json document = {{"scene", shown}, {"depth", nullptr}, {"semantics", nullptr}};
  std::string depth_line = scene.has_prior_depth() ? "kept as it is (" + scene.prior_source + ")" : "none";
  std::string semantics_line = scene.has_semantics() ? "kept as it is (" + scene.semantic_source + ")" : "none";
  if (depth) {
    const ScenePriorsReport report = fill_depth(options.scene, store, *depth, options.fill);
    document["depth"] = json_of(report);
    depth_line = line_of(report);
  }
  if (semantics) {
    const ScenePriorsReport report = fill_semantics(options.scene, store, *semantics, options.fill);
    document["semantics"] = json_of(report);
    semantics_line = line_of(report);
  }
  if (copy) place_scene(*copy, options.fill.overwrite, {scene.folder});
  if (context.global.json)
    print_json(document);
  else
    std::printf("depth      %s\nsemantics  %s\n", depth_line.c_str(), semantics_line.c_str());
}

}  // namespace

void add_priors_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("priors", "Compute depth and class priors of a scene with networks");
  command->group("Data");
  command->footer(help_footer({.reads = "a scene folder with photos",
                               .writes = "pred_depths/, pred_confidence/, segmentation_logits/, segments/ and "
                                         "priors.json of SCENE, or of the copy OUT",
                               .example = "aligngs priors scene --semantics linear-b --depth vggt",
                               .advanced = "aligngs priors scene -o filled --semantics m2f --depth none --memory 12"}));
  auto options = std::make_shared<PriorsOptions>();
  command->add_option("scene", options->scene, "scene folder")->required();
  command
      ->add_option("-o,--output", options->output,
                   "write a copy of the scene with the priors (default: SCENE itself, if aligngs wrote it)")
      ->group("Output folder");
  command
      ->add_option("--depth", options->depth,
                   words_in_help(depth_choices()) + ", none, or auto (the first of these that is installed)")
      ->capture_default_str()
      ->group("Networks");
  command
      ->add_option("--semantics", options->semantics,
                   words_in_help(semantic_choices()) + ", none, or auto (the first of these that is installed); " +
                       notes_in_help(semantic_teachers()))
      ->capture_default_str()
      ->group("Networks");
  command->add_flag("--augment", options->fill.augment, "ms: use five sizes, also mirrored (ten times slower)")
      ->group("Networks");
  command
      ->add_option("--m2f-heads", options->fill.mask2former_heads,
                   "m2f: number of attention heads, for files without 4 sampling points (default: from the tensors)")
      ->check(CLI::Range(1, 1024))
      ->group("Networks");
  command
      ->add_option("--drop-percent", options->fill.drop_percent,
                   camera_method_words(", ") + ": percentage of the depth to leave out, lowest confidence first")
      ->check(CLI::Range(0.0, 99.0))
      ->capture_default_str()
      ->group("Networks");
  add_precision_option(*command, options->precision, "Networks");
  command->add_option("--memory", options->memory_gigabytes, "memory budget in GB (default: 80 % of the free memory)")
      ->check(positive_number())
      ->group("Machine");
  command->add_flag("--overwrite", options->fill.overwrite, "replace existing priors, or the scene at OUT")
      ->group("Output folder");
  add_device_option(*command, options->device);
  command->callback([&context, options] { run_priors(context, *options); });
}

}  // namespace aligngs
