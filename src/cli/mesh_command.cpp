// `aligngs mesh RUN`: the surface of a run.
#include <CLI/App.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "cli/stages/mesh_stage.h"
#include "core/error.h"
#include "io/output_place.h"
#include "train/run_folder.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// The run's own mesh and pictures may be made again. Elsewhere no file of the run, of its scene or of a folder that
/// holds something is replaced: pictures bear the names of photos.
void require_mesh_places(const fs::path& run, const fs::path& mesh, const fs::path& pictures, const fs::path& scene) {
  const RunFolder folder(run);
  if (!mesh.empty() && !lies_within(mesh, run / "mesh")) folder.require_not_of_run(mesh, scene);
  if (pictures.empty() || lies_within(pictures, run / "renders")) return;
  folder.require_not_of_run(pictures, scene);
  require_empty_folder_place(pictures,
                             {"the folder for the pictures is taken", "--pictures", "name a new or empty folder"});
}

/// Settings of the surface, and those that the views of a run are drawn by. Others have done their work in training.
void require_settings_of_mesh(const std::vector<std::string>& sets) {
  for (const std::string& set : sets) {
    const bool counts = set.starts_with("mesh.") || set.starts_with("data.scale=") ||
                        set.starts_with("train.near_plane=") || set.starts_with("init.far_shell=") ||
                        set.starts_with("semantic.blend=");
    if (counts) continue;
    throw_usage("--set " + set + " has no effect on a mesh",
                "settings that begin with mesh. have one; `aligngs train` takes the others");
  }
}

}  // namespace

void add_mesh_command(CLI::App& program, CommandContext& context) {
  CLI::App* command =
      program.add_subcommand("mesh", "Fuse the depth of the training views into a labelled triangle mesh");
  command->group("Measure");
  command->footer(
      help_footer({.reads = "a run folder and its scene",
                   .writes = "RUN/mesh/mesh.ply, or the file of -o",
                   .example = "aligngs mesh demo_run --set mesh.voxel=0.01",
                   .advanced = "aligngs mesh demo_run --from-prior -o prior.ply --pictures prior_pictures"}));
  struct Options {
    std::string run, scene, output, pictures, device = "auto";
    bool from_prior = false, from_truth = false;
    std::vector<std::string> sets;
  };
  auto options = std::make_shared<Options>();
  command->add_option("run", options->run, "run folder")->required();
  command->add_option("--scene", options->scene, "the scene's new place, if it was moved");
  command->add_option("-o,--output", options->output, "PLY file to write (default: mesh/mesh.ply in the run)");
  command->add_option("--pictures", options->pictures,
                      "folder for pictures of the mesh by its face normals, from the test views "
                      "(default: renders/test/surface in the run)");
  CLI::Option* prior = command->add_flag("--from-prior", options->from_prior,
                                         "fuse the prior depth instead of rendered depth, as a yardstick");
  command->add_flag("--from-truth", options->from_truth, "fuse the true depth with the true cameras, as the ceiling")
      ->excludes(prior);
  command->add_option("--set", options->sets, "override a mesh setting, e.g. mesh.voxel=0.01");
  add_device_option(*command, options->device);
  command->callback([&context, options] {
    require_settings_of_mesh(options->sets);
    if (!options->output.empty()) require_output_file(options->output);
    if (!options->output.empty()) require_extension(options->output, "ply");
    LoadedRun run = load_run(
        options->run, {options->scene, context.global.threads, engine_of_device(options->device), options->sets});
    require_mesh_places(options->run, options->output, options->pictures, run.scene().folder);
    MeshStageOptions stage;
    stage.source = options->from_prior   ? DepthSource::kPrior
                   : options->from_truth ? DepthSource::kTruth
                                         : DepthSource::kRendered;
    stage.output = options->output;
    stage.pictures = options->pictures;
    stage.make_device = fusion_of_device(options->device);
    const MeshStageResult result = mesh_run(run, stage);
    const FusionReport& f = result.fusion;
    if (context.global.json) {
      const nlohmann::json document = {{"mesh", result.file.string()},
                                       {"vertices", f.vertices},
                                       {"triangles", f.triangles},
                                       {"voxel", f.voxel},
                                       {"truncation", f.truncation},
                                       {"max_depth", f.max_depth},
                                       {"predicted_bytes", f.predicted_bytes},
                                       {"labelled_vertices", result.labels.labelled}};
      print_json(document);
    } else {
      std::printf("%s: %zu vertices, %zu triangles, voxel %.4g\n", result.file.string().c_str(), f.vertices,
                  f.triangles, f.voxel);
    }
  });
}

}  // namespace aligngs
