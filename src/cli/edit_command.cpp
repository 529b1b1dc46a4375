// `aligngs edit RUN`: delete, extract, move, copy, recolour and highlight objects by name.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/number_checks.h"
#include "cli/print_json.h"
#include "cli/stages/render_stage.h"
#include "core/error.h"
#include "edit/color_names.h"
#include "edit/edit_log.h"
#include "edit/edit_products.h"
#include "edit/edit_session.h"
#include "edit/inserted_object.h"
#include "edit/mesh_selection.h"
#include "edit/motion_text.h"
#include "edit/object_scores.h"
#include "edit/removal_score.h"
#include "edit/report_json.h"
#include "edit/selection_truth.h"
#include "io/image_file.h"
#include "io/output_place.h"
#include "scene/mesh_ply.h"
#include "train/run_folder.h"

namespace aligngs {

using Json = nlohmann::json;

namespace {

struct EditOptions {
  std::string run, scene, say, select, threshold = "argmax", recolor, highlight, move, turn, output, picture, truth,
                                       replace, up = "z";
  double wait = EditSessionOptions().patience;  ///< seconds
  bool remove = false, extract = false, fill = false, with_contents = false, duplicate = false, fit = false;
  bool undo = false, list = false, dry_run = false, measure = false;
  std::string remove_selection;
  std::vector<std::string> rename_selection;  ///< old name, new name
};

void print(const CommandContext& context, const Json& json, const std::string& text) {
  if (context.global.json)
    print_json(json);
  else
    std::fputs(text.c_str(), stdout);
}

std::string report_text(const EditReport& report, const LabelSet& labels) {
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
  for (const SelectedObject& part : report.parts)
    text += "taken along  " + object_name(part, labels) + ": belongs to the selected objects\n";
  if (report.no_support) text += "no wall, floor or furniture continues behind the selection: the hole is left open\n";
  if (!report.contents.empty()) {
    std::string names;
    for (const SelectedObject& object : report.contents)
      names += (names.empty() ? "" : ", ") + object_name(object, labels);
    text += "left behind  " + names + ": on the selected objects before; --with-contents takes them along\n";
  }
  return text;
}

void list_run(const CommandContext& context, EditSession& session) {
  Json edits = Json::array(), objects = Json::array(), selections = Json::array();
  std::string text = session.stack().empty() ? "no edits\n" : "edits, oldest first:\n";
  for (const EditOperation& edit : session.stack()) {
    edits.push_back(describe(edit));
    text += "  " + describe(edit) + "\n";
  }
  text += "objects:\n";
  for (const Instance& object : session.objects()) {
    const std::string name =
        session.room().labels.classes.at(static_cast<size_t>(object.label)).name + "#" + std::to_string(object.number);
    objects.push_back({{"object", name},
                       {"gaussians", object.gaussians},
                       {"centre", {object.centre.x, object.centre.y, object.centre.z}}});
    text += "  " + name + ": " + std::to_string(object.gaussians) + " Gaussians\n";
  }
  const RoomSelections& drawn = session.selections();
  if (!drawn.list.empty()) text += "selections by hand:\n";
  for (const NamedSelection& s : drawn.list) {
    selections.push_back({{"name", s.name}, {"gaussians", s.count()}, {"usable", drawn.is_usable(s)}});
    text += "  " + s.name + ": " + std::to_string(s.count()) + " Gaussians" +
            (drawn.is_usable(s) ? "" : " of another training") + "\n";
  }
  print(context, {{"edits", edits}, {"objects", objects}, {"selections", selections}}, text);
}

/// Gives a selection another name, or removes it.
void change_selection(const CommandContext& context, EditSession& session, const EditOptions& options) {
  if (!options.remove_selection.empty()) {
    session.remove_selection(options.remove_selection);
    return print(context, {{"removed", options.remove_selection}}, "removed: " + options.remove_selection + "\n");
  }
  const std::string &from = options.rename_selection[0], &to = options.rename_selection[1];
  session.rename_selection(from, to);
  print(context, {{"renamed", from}, {"to", to}}, "renamed: " + from + " to " + to + "\n");
}

/// Every object of a synthetic room.
void measure_objects(const CommandContext& context, EditSession& session) {
  const TriangleMesh truth = read_mesh_ply(session.scene().truth_mesh);
  const std::filesystem::path list = session.scene().truth_mesh.parent_path() / "objects.json";
  const std::vector<ObjectScore> scores =
      score_objects(session.room(), truth, read_true_objects(list, truth.vertices.size()), session.pool());
  Json objects = Json::array();
  std::string text;
  double sum = 0;
  for (const ObjectScore& s : scores) {
    objects.push_back({{"object", s.object}, {"selection", s.selection}, {"iou", s.iou}, {"area", s.area}});
    char line[200];
    std::snprintf(line, sizeof line, "%-24s IoU %.3f  %7.3f m2  %s\n", s.object.c_str(), s.iou, s.area,
                  s.selection.empty() ? "no selection touches it" : s.selection.c_str());
    text += line;
    sum += s.iou;
  }
  const double mean = scores.empty() ? 0 : sum / static_cast<double>(scores.size());
  char line[100];
  std::snprintf(line, sizeof line, "%-24s IoU %.3f  of %zu objects\n", "mean", mean, scores.size());
  print(context, {{"objects", objects}, {"mean_iou", mean}}, text + line);
}

void measure(const CommandContext& context, EditSession& session, const EditOptions& options) {
  const EditableRoom& room = session.room();
  if (session.scene().truth_mesh.empty()) {
    throw_bad_input(session.scene().folder / "truth", "mesh.ply", "the scene has no true mesh to measure against",
                    "use a synthetic room, or leave out --measure");
  }
  if (room.mesh.vertices.empty()) {
    throw_bad_input(session.folder() / "mesh", "mesh.ply", "the run has no mesh", "make it first: aligngs mesh RUN");
  }
  if (options.select.empty()) return measure_objects(context, session);
  const SelectionQuery query = read_selection(room, options.select);
  const GaussianSelection selection =
      select_gaussians(room.gaussians, query, parse_threshold(options.threshold), room.labels, {}, session.pool());
  std::vector<Camera> cameras;
  for (const int view : session.scene().train)
    cameras.push_back(session.scene().evaluation_cameras[static_cast<size_t>(view)]);
  const SelectionScore s = score_selection(
      room.mesh,
      select_vertices(room.mesh, room.gaussians.model, selection.mask, room.gaussians.extent, session.pool()),
      read_mesh_ply(session.scene().truth_mesh), query, cameras, session.pool());
  char text[400];
  std::snprintf(text, sizeof text,
                "selected     %zu Gaussians, %.3f m2 of mesh; visible true surface %.3f m2\n"
                "labels       IoU %.3f over the reconstructed surface, which measures the selection\n"
                "surface      IoU %.3f at 5 cm (precision %.3f, recall %.3f), which measures selection and geometry\n",
                selection.count, s.selected_area, s.true_area, s.label_iou, s.iou, s.precision, s.recall);
  print(context,
        {{"selection", selection_text(query, room.labels)},
         {"gaussians", selection.count},
         {"label_iou", s.label_iou},
         {"surface_iou", s.iou},
         {"precision", s.precision},
         {"recall", s.recall},
         {"selected_area", s.selected_area},
         {"true_area", s.true_area}},
        text);
}

EditOperation operation_of(const EditOptions& options) {
  EditOperation edit;
  const bool replaces = !options.replace.empty();
  const bool moves = options.duplicate || !options.move.empty() || (!options.turn.empty() && !replaces);
  const int operations =
      options.remove + options.extract + moves + replaces + !options.recolor.empty() + !options.highlight.empty();
  if (operations != 1)
    throw_usage(
        "an edit needs exactly one of --delete, --extract, --move (or --turn), --duplicate, --replace, --recolor, "
        "--highlight",
        "`aligngs edit --help` shows an example");
  edit.kind = options.remove             ? EditKind::kDelete
              : options.extract          ? EditKind::kExtract
              : options.duplicate        ? EditKind::kDuplicate
              : moves                    ? EditKind::kMove
              : replaces                 ? EditKind::kReplace
              : !options.recolor.empty() ? EditKind::kRecolor
                                         : EditKind::kHighlight;
  if (options.fill && !options.remove)
    throw_usage("--fill closes the hole that --delete leaves", "use it with --delete");
  if (edit.kind == EditKind::kRecolor) edit.color = read_color(options.recolor);
  if (edit.kind == EditKind::kHighlight) edit.color = read_color(options.highlight);
  if (options.with_contents && takes_color(edit.kind))
    throw_usage("--with-contents takes along what is on the objects",
                "use it with --delete, --extract, --move or --duplicate");
  if (!replaces && (options.fit || options.up != "z"))
    throw_usage("--fit and --up are about the object of --replace", "use them with --replace");
  edit.fill = options.fill || edit.kind == EditKind::kMove || replaces;
  edit.with = options.replace;
  edit.fit = options.fit;
  parse_axis(options.up);  // refuses other words
  edit.up_axis = options.up;
  if (!options.move.empty()) edit.motion.shift = parse_shift(options.move);
  if (!options.turn.empty()) edit.motion.turn = parse_turn(options.turn);
  edit.with_contents = options.with_contents;
  edit.select = options.select;
  edit.threshold = parse_threshold(options.threshold);
  return edit;
}

/// Compares a run that `aligngs edit -o` wrote with the scene's truth without the object.
void measure_removal(const CommandContext& context, const EditOptions& options) {
  const OpenedRun run = open_run(options.run, options.scene);
  ThreadPool pool(context.global.threads);
  const std::filesystem::path mesh_file = run.folder / "mesh" / "mesh.ply";
  std::vector<Camera> cameras;
  for (const int view : run.scene.train) cameras.push_back(run.scene.evaluation_cameras[static_cast<size_t>(view)]);
  const RemovalScore s =
      score_removal(run.folder / "renders" / "test" / "rgb", options.truth,
                    std::filesystem::exists(mesh_file) ? read_mesh_ply(mesh_file) : TriangleMesh(), cameras, pool);
  char text[300];
  std::snprintf(text, sizeof text,
                "PSNR %.2f dB and SSIM %.3f where %zu test views show the object\n"
                "F %.3f at 5 cm (precision %.3f, recall %.3f) in the object's box\n",
                s.psnr, s.ssim, s.views, s.fscore, s.precision, s.recall);
  print(context,
        {{"truth", options.truth},
         {"views", s.views},
         {"psnr", s.psnr},
         {"ssim", s.ssim},
         {"precision", s.precision},
         {"recall", s.recall},
         {"fscore", s.fscore}},
        text);
}

/// With --say everything about the edit is in the sentence.
void require_only_a_sentence(const EditOptions& options) {
  if (options.remove || options.extract || options.fill || options.with_contents || options.duplicate ||
      !options.move.empty() || !options.turn.empty() || !options.replace.empty() || options.fit ||
      !options.recolor.empty() || !options.highlight.empty() || !options.select.empty() || options.undo ||
      options.list || options.measure) {
    throw_usage("--say is a whole edit by itself", "leave out --select and the operation, or leave out --say");
  }
}

/// Opens the run only for an edit from which later ones follow.
void undo(const CommandContext& context, const EditOptions& options, size_t number) {
  std::optional<EditOperation> undone = undo_in_files(options.run, number, options.wait);
  if (!undone) undone = EditSession(options.run, {options.scene, context.global.threads, options.wait}).undo(number);
  const std::string text = describe(*undone);
  print(context, {{"undone", text}, {"edits", read_edits(std::filesystem::path(options.run) / "edits.json").size()}},
        "undone: " + text + "\n");
}

/// A sentence that asks for an undo needs no room.
std::optional<size_t> undo_in_words(const EditOptions& options) {
  if (options.say.empty()) return std::nullopt;
  try {
    return parse_request(options.say).undo;
  } catch (const Error&) {
    return std::nullopt;  // read again with the words of the room, for its suggestions
  }
}

void run_edit(const CommandContext& context, const EditOptions& options) {
  if (!options.truth.empty()) {
    if (!options.select.empty() || !options.say.empty() || options.undo || options.list) {
      throw_usage("--truth measures a run that `aligngs edit -o` wrote",
                  "make that run first: aligngs edit RUN --select ... --delete -o NEW_RUN");
    }
    return measure_removal(context, options);
  }
  const bool says = !options.say.empty();
  if (says) require_only_a_sentence(options);
  const bool renames = !options.rename_selection.empty(), removes = !options.remove_selection.empty();
  const bool looks = options.undo || options.list || says || renames || removes;
  if (options.undo + options.list + options.dry_run + options.measure + renames + removes > 1) {
    throw_usage("--undo, --list, --dry-run, --measure, --rename-selection and --remove-selection exclude each other");
  }
  if ((renames || removes) && (says || !options.select.empty() || !options.output.empty())) {
    throw_usage("a selection is renamed or removed by itself", "leave out the edit and -o");
  }
  if (!looks && !options.measure && options.select.empty())
    throw_usage("nothing is selected", "say which objects: --select \"pillow, cushion#2\"");
  const bool edits = !looks && !options.measure;
  EditOperation edit = edits ? operation_of(options) : EditOperation{};
  // Before the run is opened, which takes seconds: a place that is taken, a word that cannot be read.
  if ((edits || says) && !options.dry_run && !options.output.empty())
    require_new_folder(options.output, {options.run, options.scene});
  const std::string picture_file = options.picture.empty() && options.dry_run ? "edit_preview.png" : options.picture;
  if (!picture_file.empty()) {
    if (options.undo || options.list || options.measure || renames || removes || !options.output.empty())
      throw_usage("--picture shows one edit before and after", "use it with an edit or with --dry-run");
    require_file_place(picture_file);
    require_extension(picture_file, "png");
    RunFolder(options.run).require_not_of_run(picture_file, options.scene);
  }
  const std::optional<size_t> number = options.undo ? std::optional<size_t>(0) : undo_in_words(options);
  if (number && (options.dry_run || !options.output.empty()))
    throw_usage("undo changes this run", "leave out --dry-run and -o");
  if (number) return undo(context, options, *number);
  EditSession session(options.run, {options.scene, context.global.threads, options.wait});
  if (options.list) return list_run(context, session);
  if (renames || removes) return change_selection(context, session, options);
  if (options.measure) return measure(context, session, options);
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
    return print(context, json,
                 report_text(report, labels) + "picture      " + picture_file + " (view " + picture.view +
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
    return print(context, json, report_text(report, labels) + "run          " + options.output + "\n");
  }
  BeforeAfter picture;
  const EditReport report = session.push(edit, picture_file.empty() ? nullptr : &picture);
  Json json = report_json(report, labels);
  std::string text = report_text(report, labels);
  if (!picture_file.empty()) {
    write_before_after(picture_file, picture);
    json["picture"] = picture_file;
    json["view"] = picture.view;
    text += "picture      " + picture_file + " (view " + picture.view + ")\n";
  }
  print(
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
                            "Another object in place of one:\n"
                            "  aligngs edit RUN --select armchair --replace other_run#sofa#1\n"
                            "  aligngs edit RUN --select armchair --replace chair.ply --up=-y --fit --turn 90"}));
  auto options = std::make_shared<EditOptions>();
  command->add_option("run", options->run, "run folder")->required();
  command->add_option("--scene", options->scene, "the scene's new place, if it was moved");
  command->add_option("--say", options->say, "the edit in words: \"recolor sofa dark green\", \"undo the second edit\"")
      ->group("Edit");
  command
      ->add_option("--select", options->select,
                   "objects by name, e.g. \"pillow, cushion#2\", or a selection that was drawn on the page")
      ->group("Selection");
  command->add_option("--threshold", options->threshold, "argmax, auto, or a probability (0 to 1)")
      ->capture_default_str()
      ->group("Selection");
  command->add_flag("--delete", options->remove, "remove the selected objects")->group("Edit");
  command->add_flag("--fill", options->fill, "with --delete: continue the surfaces behind and under the objects")
      ->group("Edit");
  command->add_flag("--with-contents", options->with_contents, "also what is on the objects; not for colours")
      ->group("Edit");
  command->add_flag("--extract", options->extract, "keep the selected objects only")->group("Edit");
  command
      ->add_option("--move", options->move,
                   "move by RIGHT,UP,TOWARDS in metres as the photos' cameras see it, e.g. 0.5,0,-0.2")
      ->group("Edit");
  command
      ->add_option("--turn", options->turn,
                   "turn by degrees, counter-clockwise from above; also with --move and --replace")
      ->group("Edit");
  command->add_flag("--duplicate", options->duplicate, "copy the objects, to the right of them or by --move and --turn")
      ->group("Edit");
  command
      ->add_option("--replace", options->replace,
                   "put another object in their place: FILE.ply, or RUN#OBJECT such as other_run#armchair#1")
      ->group("Edit");
  command->add_flag("--fit", options->fit, "with --replace: scale the other object to the box of the old one")
      ->group("Edit");
  command->add_option("--up", options->up, "with --replace FILE.ply: its upward axis, x, y, z, -x, -y or -z")
      ->capture_default_str()
      ->group("Edit");
  command
      ->add_option("--recolor", options->recolor,
                   "give the objects this colour, '#rrggbb' or a name; light and texture stay")
      ->group("Edit");
  command->add_option("--highlight", options->highlight, "mix the objects with this colour, '#rrggbb' or a name")
      ->group("Edit");
  command->add_option("-o,--output", options->output, "write a new run instead of editing this one")
      ->group("Stack and output");
  command->add_flag("--dry-run", options->dry_run, "only count, and write a picture of before and after")
      ->group("Stack and output");
  command
      ->add_option("--picture", options->picture,
                   "draw a test view before and after the edit into this file (--dry-run: edit_preview.png)")
      ->group("Stack and output");
  command->add_flag("--undo", options->undo, "take the last edit back")->group("Stack and output");
  command->add_option("--wait", options->wait, "seconds to wait for another edit of this run")
      ->check(number_from_zero())
      ->capture_default_str()
      ->group("Stack and output");
  command->add_flag("--list", options->list, "list the edits, the objects of the room and the selections by hand")
      ->group("Selection");
  command
      ->add_option("--rename-selection", options->rename_selection,
                   "give a selection that was drawn on the page another name: OLD NEW")
      ->expected(2)
      ->group("Selection");
  command->add_option("--remove-selection", options->remove_selection, "forget a selection that was drawn on the page")
      ->group("Selection");
  command
      ->add_option("--truth", options->truth,
                   "compare a run made with -o with a folder SCENE/truth/without/NAME of `synth --without`")
      ->group("Stack and output");
  command
      ->add_flag("--measure", options->measure,
                 "compare the selection, or without --select every object, with the true ones of the scene (IoU)")
      ->group("Selection");
  command->callback([&context, options] { run_edit(context, *options); });
}

}  // namespace aligngs
