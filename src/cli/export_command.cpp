// `aligngs export RUN`: files for other programs.
#include <fmt/format.h>
#include <CLI/App.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "core/error.h"
#include "core/letter_case.h"
#include "core/log.h"
#include "edit/edit_session.h"
#include "io/output_place.h"
#include "serve/export_file.h"
#include "train/run_folder.h"

namespace aligngs {
namespace {

double megabytes(uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

/// Before the file is written: what it is about to hold.
void tell_html_size(const HtmlSize& size) {
  std::string parts = fmt::format("splats {:.1f}", megabytes(size.splats));
  if (size.mesh > 0) parts += fmt::format(", mesh {:.1f}", megabytes(size.mesh));
  if (size.before + size.before_mesh > 0)
    parts += fmt::format(", the room before its edits {:.1f}", megabytes(size.before + size.before_mesh));
  log_info("about {:.1f} MB: {}, the page itself {:.1f}", megabytes(size.total()), parts, megabytes(size.page));
}

/// Names of the formats that `wanted` is true for.
template <class Wanted>
std::string formats_where(Wanted wanted) {
  std::vector<std::string> names;
  for (const RunExportFormat& format : run_export_rows()) {
    if (wanted(format)) names.emplace_back(format.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

bool has_one_part(const RunExportFormat& format) { return format.room && format.room->one_part; }
bool has_chosen_texture(const RunExportFormat& format) {
  return format.room && format.room->texture == ExportTexture::kAsked;
}

struct ExportCommandOptions {
  std::string run, scene, format, output, only;
  bool keep_frame = false, original_coordinates = false, mesh_only = false, splats_only = false;
  bool no_before = false;
  RunExportOptions what;
};

/// Error{kUsage} for options that are of other formats.
void require_options_of(const RunExportFormat& format, const ExportCommandOptions& options) {
  const RunExportOptions& what = options.what;
  const bool page = format.kind == ExportKind::kPage;
  if (page && what.parts == RoomParts::kMesh)
    throw_usage("the page always has splats", "leave the option out, or use --splats-only");
  if (options.no_before && !page) throw_usage("--no-before is for -f html", "other files hold the edited room alone");
  if (what.parts != RoomParts::kAll && !has_one_part(format) && !page) {
    throw_usage(fmt::format("one part alone is for -f {} and html", formats_where(has_one_part)),
                "leave the option out: " + options.format + " holds one kind of thing");
  }
  const bool shaped = what.triangles > 0 || what.error > 0 || what.closed || what.textured;
  if (shaped && (!format.mesh() || what.parts == RoomParts::kSplats)) {
    throw_usage("--triangles, --error, --closed and --textured are for a mesh, and this file has none",
                "formats with a mesh: " + formats_where([](const auto& row) { return row.mesh(); }));
  }
  if (what.textured && page) throw_usage("the mesh of the page has colours of its vertices", "leave --textured out");
  if (what.textured && format.room->texture == ExportTexture::kNone)
    throw_usage(fmt::format("the mesh of {} has no colours", format.name), "leave --textured out");
  if (!what.object.empty() && format.plan) throw_usage("a plan is of the whole room", "leave --object out");
  if (options.original_coordinates && !format.room) {
    throw_usage("--original-coordinates is for files of splats and meshes",
                "leave it out: a page has the run's coordinates, and a plan those of the room");
  }
  if (options.keep_frame && format.plan)
    throw_usage("a plan has the coordinates of the room", "leave --keep-frame out");
}

void print_export(const CommandContext& context, const RunExport& made, const RunExportOptions& what) {
  const ExportReport& report = made.report;
  const std::filesystem::path& file = made.file;
  uint64_t bytes = 0;
  for (const std::filesystem::path& f : report.files) bytes += std::filesystem::file_size(f);
  if (context.global.json) {
    nlohmann::json document = {{"file", file.string()},         {"bytes", bytes},
                               {"gaussians", report.gaussians}, {"invisible", report.invisible},
                               {"objects", report.objects},     {"edits", made.edits},
                               {"aligned", made.aligned},       {"before", made.before},
                               {"triangles", report.triangles}, {"triangles_before", report.triangles_before}};
    document["files"] = nlohmann::json::array();
    for (const std::filesystem::path& f : report.files) document["files"].push_back(f.string());
    if (what.closed) document["open_edges"] = report.open_edges;
    print_json(document);
    return;
  }
  std::string text = fmt::format("{}: {:.2f} MB", file.string(), static_cast<double>(bytes) / 1e6);
  if (report.gaussians > 0) text += fmt::format(", {} Gaussians", report.gaussians);
  if (report.invisible > 0) text += fmt::format(" without {} that nobody can see", report.invisible);
  if (report.triangles > 0) text += fmt::format(", {} triangles", report.triangles);
  if (report.triangles < report.triangles_before) text += fmt::format(" of {}", report.triangles_before);
  if (report.objects > 0) text += fmt::format(", {} objects", report.objects);
  if (made.edits > 0) text += ", with the edits of the run";
  if (made.before) text += " and the room before them";
  if (what.closed) text += report.open_edges == 0 ? ", closed" : fmt::format(", open at {} edges", report.open_edges);
  std::printf("%s\n", text.c_str());
  if (what.triangles > 0 && report.triangles > what.triangles) {
    std::fprintf(stderr,
                 "%zu triangles were asked for: borders between objects and edges of three triangles keep more\n",
                 what.triangles);
  }
}

}  // namespace

void add_export_command(CLI::App& program, CommandContext& context) {
  std::string notes;  // a line for each format
  for (const RunExportFormat& format : run_export_rows()) notes += fmt::format("{}: {}\n", format.name, format.help);
  notes += "Photos are the texture of --textured.";
  CLI::App* command = program.add_subcommand("export", "Write the room with its edits for other programs");
  command->group("Use");
  command->footer(
      help_footer({.reads = "a run folder, with its edits",
                   .writes = "RUN/scene.FORMAT, or the file of -o",
                   .example = "aligngs export demo_run -f glb",
                   .advanced = "aligngs export demo_run -f glb --mesh-only --textured --triangles 50000 -o room.glb",
                   .notes = notes.c_str()}));
  auto options = std::make_shared<ExportCommandOptions>();
  command->add_option("run", options->run, "run folder")->required();
  command->add_option("--scene", options->scene, "the scene's new place, if it was moved");
  command->add_option("-f,--format", options->format, fmt::format("format: {}", fmt::join(run_export_formats(), ", ")))
      ->required();
  command->add_option("-o,--output", options->output,
                      "file to write (default: scene.<format> in the run, scene.edited.<format> after edits, and "
                      "scene.export.ply for ply)");
  CLI::Option* only =
      command
          ->add_option("--only", options->only,
                       formats_where(has_one_part) + ": mesh or splats alone (default: both); html: splats alone")
          ->check(CLI::IsMember({"mesh", "splats"}));
  CLI::Option* mesh_only =
      command->add_flag("--mesh-only", options->mesh_only, "the same as --only mesh")->excludes(only);
  command->add_flag("--splats-only", options->splats_only, "the same as --only splats")
      ->excludes(only)
      ->excludes(mesh_only);
  command->add_option("--object", options->what.object,
                      "only these objects, as pillow.002, \"pillow#2\" or \"bed, pillow\"");
  command->add_option("--triangles", options->what.triangles, "simplify the mesh to at most this number of triangles")
      ->check(CLI::Range(uint64_t(4), uint64_t(1) << 31));
  command
      ->add_option("--error", options->what.error,
                   "simplify the mesh as long as its surface moves by less, in millimetres")
      ->check(CLI::Range(0.01, 10000.0));
  command->add_flag("--closed", options->what.closed, "close the holes of the mesh, also where no photo has looked");
  command->add_flag("--textured", options->what.textured,
                    formats_where(has_chosen_texture) +
                        ": a texture from the photos; at most 100000 triangles without another limit");
  CLI::Option* texture_size = command
                                  ->add_option("--texture-size", options->what.texture_size,
                                               "pixels, side of the texture at most (default: 4096)")
                                  ->check(CLI::Range(256, 16384));
  command->add_flag("--original", options->what.original, "leave out the edits of the run");
  command->add_flag("--no-before", options->no_before,
                    "html: leave out the room before its edits, and with it what they deleted");
  command->add_flag(
      "--keep-frame", options->keep_frame,
      "coordinates of the scene, in the axes of the format (default: as room.json has them, if the run has it)");
  command
      ->add_flag("--original-coordinates", options->original_coordinates,
                 "coordinates of the files that the scene was imported from")
      ->excludes("--keep-frame");
  command->callback([&context, options, texture_size] {
    // Before the run is opened, which takes seconds.
    options->format = lower_case(options->format);
    const RunExportFormat& format = run_export_row(options->format);
    RunExportOptions& what = options->what;
    if (options->only == "mesh" || options->mesh_only) what.parts = RoomParts::kMesh;
    if (options->only == "splats" || options->splats_only) what.parts = RoomParts::kSplats;
    what.before = !options->no_before;
    const bool has_texture = what.textured || (format.room && format.room->texture == ExportTexture::kAlways);
    if (texture_size->count() > 0 && !has_texture)
      throw_usage("--texture-size is for a mesh with a texture", "add --textured, or leave --texture-size out");
    require_options_of(format, *options);
    if (!options->output.empty()) require_output_file(options->output);
    if (!options->output.empty()) require_extension(options->output, options->format);
    if (!options->output.empty()) RunFolder(options->run).require_not_of_run(options->output, options->scene);
    what.file = options->output;
    what.coordinates = options->original_coordinates ? ExportCoordinates::kOriginal
                       : options->keep_frame         ? ExportCoordinates::kScene
                                                     : ExportCoordinates::kRoom;
    EditSession session(options->run, {options->scene, context.global.threads});
    if (format.kind == ExportKind::kPage) tell_html_size(estimate_html_export(session, what));
    const RunExport made = export_run(session, options->format, what);
    print_export(context, made, what);
  });
}

}  // namespace aligngs
