// `aligngs export RUN`: files for other programs.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "core/error.h"
#include "edit/edit_session.h"
#include "io/output_place.h"
#include "serve/export_file.h"
#include "train/run_folder.h"

namespace aligngs {

void add_export_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("export", "Write the room with its edits for other programs");
  command->group("Use");
  command->footer(help_footer({.reads = "a run folder, with its edits",
                                .writes = "RUN/scene.FORMAT, or the file of -o",
                                .example = "aligngs export demo_run -f glb",
                                .advanced = "aligngs export demo_run -f glb --only mesh --original -o room.glb",
                                .notes = "ply, splat: splats; labels.ply: splats with class, object and confidence; sog, spz: compressed splats.\n"
                                         "glb: a node per object, and the splats; obj: groups per object; html: one page that opens without a server.\n"
                                         "usda: USD with a prim per object: label, splats, mesh and collider.\n"
                                         "plan.svg, plan.dxf, plan.pdf: floor plan to scale, from room.json."}));
  struct Options {
    std::string run, scene, format, output, only;
    bool original = false, keep_frame = false, original_coordinates = false;
  };
  auto options = std::make_shared<Options>();
  command->add_option("run", options->run, "run folder")->required();
  command->add_option("--scene", options->scene, "the scene's new place, if it was moved");
  command->add_option("-f,--format", options->format, "ply, labels.ply, glb, obj, sog, spz, splat, usda, html, plan.svg, plan.dxf or plan.pdf")->required();
  command->add_option("-o,--output", options->output, "file to write (default: scene.<format> in the run, and scene.export.ply for ply)");
  command->add_option("--only", options->only, "glb, usda: mesh or splats alone (default: both)")->check(CLI::IsMember({"mesh", "splats"}));
  command->add_flag("--original", options->original, "leave out the edits of the run");
  command->add_flag("--keep-frame", options->keep_frame, "leave coordinates as they are (default: as room.json has them, if the run has it)");
  command->add_flag("--original-coordinates", options->original_coordinates, "coordinates of the files that the scene was imported from")->excludes("--keep-frame");
  command->callback([&context, options] {
    // Before the run is opened, which takes seconds.
    require_export_format(options->format, run_export_formats());
    if (!options->only.empty() && options->format != "glb" && options->format != "usda") throw_usage("--only is for -f glb and -f usda", "leave it out: " + options->format + " holds one kind of thing");
    const RoomParts parts = options->only == "mesh" ? RoomParts::kMesh : options->only == "splats" ? RoomParts::kSplats : RoomParts::kAll;
    if (!options->output.empty()) require_extension(options->output, options->format);
    if (!options->output.empty()) RunFolder(options->run).require_not_of_run(options->output, options->scene);
    EditSession session(options->run, {options->scene, context.global.threads});
    const RunExport made = export_run(session, options->format, options->original, options->output, parts,
                                      options->original_coordinates ? ExportCoordinates::kOriginal
                                      : options->keep_frame         ? ExportCoordinates::kScene
                                                                    : ExportCoordinates::kRoom);
    const ExportReport& report = made.report;
    const std::filesystem::path& file = made.file;
    const uint64_t bytes = std::filesystem::file_size(report.files.front());
    if (context.global.json) {
      const nlohmann::json document = {{"file", file.string()}, {"bytes", bytes}, {"gaussians", report.gaussians},
                                       {"objects", report.objects}, {"edits", made.edits}, {"aligned", made.aligned}};
      print_json(document);
    } else {
      if (report.gaussians == 0) {
        std::printf("%s: %.2f MB\n", file.string().c_str(), static_cast<double>(bytes) / 1e6);
        return;
      }
      std::printf("%s: %.2f MB, %zu Gaussians, %zu objects%s\n", file.string().c_str(),
                  static_cast<double>(bytes) / 1e6, report.gaussians, report.objects,
                  made.edits > 0 ? ", with the edits of the run" : "");
    }
  });
}

}  // namespace aligngs
