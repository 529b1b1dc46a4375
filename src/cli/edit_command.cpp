// `aligngs edit RUN`: delete, extract, move, copy, recolour and highlight objects by name.
#include <CLI/App.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/edit_list.h"
#include "cli/edit_measures.h"
#include "cli/edit_options.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "cli/stages/render_stage.h"
#include "core/error.h"
#include "core/free_memory.h"
#include "edit/edit_log.h"
#include "edit/edit_products.h"
#include "edit/edit_session.h"
#include "edit/report_json.h"
#include "io/output_place.h"
#include "train/run_folder.h"

namespace aligngs {

using Json = nlohmann::json;

namespace {

/// `stored`: the edit joined those of the run, so that it can be undone.
std::string report_text(const EditReport& report, const LabelSet& labels, bool stored) {
  std::string text = report.description + "\n";
  for (const SelectedObject& object : report.objects) {
    text += "  " + object_name(object, labels) + ": " + std::to_string(object.gaussians) + " Gaussians\n";
  }
  text += "Gaussians    " + std::to_string(report.selected) + " selected, " + std::to_string(report.before) +
          " before, " + std::to_string(report.after) + " after" +
          (report.filled ? ", " + std::to_string(report.filled) + " of them new behind and under it" : "") + "\n";
  if (report.vertices_before) {
    text += "mesh         " + std::to_string(report.selected_vertices) + " vertices selected, " +
            std::to_string(report.vertices_before) + " before, " + std::to_string(report.vertices_after) + " after\n";
  }
  if (report.replacement) {
    text += "came         " + object_name(*report.replacement, labels) + ": " + std::to_string(report.inserted) +
            " Gaussians" + (report.inserted_triangles ? "" : ", without a mesh") + "\n";
  }
  for (const std::string& name : report.absent) text += "not there    " + name + ": the room has no such object\n";
  for (const SelectedObject& part : report.parts)
    text += "taken along  " + object_name(part, labels) + ": belongs to the selected objects\n";
  for (const std::string& warning : report.warnings)
    text += "warning      " + warning + (stored ? "; --undo takes the edit back\n" : "\n");
  if (report.no_support) text += "no wall, floor or furniture continues behind the selection: the hole is left open\n";
  if (!report.contents.empty()) {
    std::string names;
    for (const SelectedObject& object : report.contents)
      names += (names.empty() ? "" : ", ") + object_name(object, labels);
    text += "left behind  " + names + ": on the selected objects before; --with-contents takes them along\n";
  }
  return text;
}

/// Gives a selection another name, or removes it.
void change_selection(const CommandContext& context, EditSession& session, const EditOptions& options) {
  if (!options.remove_selection.empty()) {
    session.remove_selection(options.remove_selection);
    return print_result(context, Json{{"removed", options.remove_selection}},
                        "removed: " + options.remove_selection + "\n");
  }
  const std::string &from = options.rename_selection[0], &to = options.rename_selection[1];
  session.rename_selection(from, to);
  print_result(context, Json{{"renamed", from}, {"to", to}}, "renamed: " + from + " to " + to + "\n");
}

/// Opens the run only for an edit from which later ones follow.
void undo(const CommandContext& context, const EditOptions& options, const UndoRequest& request) {
  std::vector<EditOperation> undone;
  if (request.number == 0) {
    undone = undo_latest_in_files(options.run, request.latest, options.wait);
  } else if (const auto one = undo_in_files(options.run, request.number, options.wait)) {
    undone.push_back(*one);
  } else {
    EditSession session(options.run, {options.scene, context.global.threads, options.wait});
    undone.push_back(session.undo(request.number));
  }
  std::string lines;
  for (const EditOperation& edit : undone) lines += "undone: " + describe(edit) + "\n";
  print_result(context,
               Json{{"undone", describe(undone)},
                    {"edits", read_edits(std::filesystem::path(options.run) / "edits.json").size()}},
               lines);
}

void run_edit(const CommandContext& context, const EditOptions& options) {
  keep_freed_memory();
  require_consistent(options);
  if (!options.truth.empty()) return measure_removal(context, options);
  const bool says = !options.say.empty(), changes_selection = options.changes_selection();
  const bool edits = options.is_edit();
  EditOperation edit = edits ? operation_of(options) : EditOperation{};
  // Before the run is opened, which takes seconds: a place that is taken, a word that cannot be read.
  if ((edits || says) && !options.dry_run && !options.output.empty())
    require_new_folder(options.output, {options.run, options.scene});
  const std::string picture_file = options.picture.empty() && options.dry_run ? "edit_preview.png" : options.picture;
  if (!picture_file.empty()) {
    if (options.undo || options.list || options.measure || changes_selection || !options.output.empty())
      throw_usage("--picture shows one edit before and after", "use it with an edit or with --dry-run");
    require_output_file(picture_file);
    require_extension(picture_file, "png");
    RunFolder(options.run).require_not_of_run(picture_file, options.scene);
  }
  const std::optional<UndoRequest> taken = options.undo ? UndoRequest{} : undo_in_words(options);
  if (taken && (options.dry_run || !options.output.empty()))
    throw_usage("undo changes this run", "leave out --dry-run and -o");
  if (taken) return undo(context, options, *taken);
  EditSession session(options.run, {options.scene, context.global.threads, options.wait, true});
  if (options.list) return list_run(context, session);
  if (changes_selection) return change_selection(context, session, options);
  if (options.measure) return measure_selection(context, session, options);
  if (says) edit = session.understand(options.say).edit;
  const LabelSet& labels = session.room().labels;
  if (options.dry_run) {
    BeforeAfter picture;
    const EditReport report = session.preview(edit, &picture);
    RunFolder(options.run).require_not_of_run(picture_file, session.scene().folder);
    write_before_after(picture_file, picture);
    Json json = report_json(report, labels);
    json["picture"] = picture_file;
    json["view"] = picture.view;
    return print_result(context, json,
                        report_text(report, labels, false) + "picture      " + picture_file + " (view " + picture.view +
                            "); nothing else was written\n");
  }
  if (!options.output.empty()) {
    const EditReport report = session.write_run(options.output, edit, context.command_line);
    LoadedRun edited = load_run(options.output, {{}, context.global.threads});
    RenderStageOptions render;
    render.progress = context.progress();
    render_views(edited, render);
    Json json = report_json(report, labels);
    json["run"] = options.output;
    return print_result(context, json, report_text(report, labels, false) + "run          " + options.output + "\n");
  }
  BeforeAfter picture;
  const EditReport report = session.push(edit, picture_file.empty() ? nullptr : &picture);
  Json json = report_json(report, labels);
  std::string text = report_text(report, labels, true);
  if (!picture_file.empty()) {
    write_before_after(picture_file, picture);
    json["picture"] = picture_file;
    json["view"] = picture.view;
    text += "picture      " + picture_file + " (view " + picture.view + ")\n";
  }
  print_result(
      context, json,
      text + "look at it   aligngs view " + options.run + "; take it back: aligngs edit " + options.run + " --undo\n");
}

}  // namespace

void add_edit_command(CLI::App& program, CommandContext& context) {
  CLI::App* command =
      program.add_subcommand("edit", "Delete, extract, move, copy, replace, recolour or highlight objects by name");
  command->group("Use");
  command->footer(
      help_footer({.reads = "a run folder",
                   .writes = "RUN/edits.json and a small file in RUN/edits/; with -o a new run instead",
                   .example = "aligngs edit demo_run --select \"pillow, cushion\" --recolor '#add8e6'",
                   .advanced = "aligngs edit demo_run --select \"everything but wall, floor\" --extract -o furniture",
                   .notes = "An edit goes on a stack beside the run, and --undo takes it back.\n"
                            "Training results never change. With -o the run itself stays untouched.\n"
                            "Objects by place and size, also after --say:\n"
                            "  aligngs edit RUN --select \"the pillow on the bed\" --delete --fill\n"
                            "  aligngs edit RUN --select \"all furniture but the bed\" --highlight orange\n"
                            "  aligngs edit RUN --say \"delete everything on the table\"\n"
                            "Another object in place of one:\n"
                            "  aligngs edit RUN --select armchair --replace other_run#sofa#1\n"
                            "  aligngs edit RUN --select armchair --replace chair.ply --up=-y --fit --turn 90"}));
  const std::shared_ptr<EditOptions> options = add_edit_options(*command);
  command->callback([&context, options] { run_edit(context, *options); });
}

}  // namespace aligngs
