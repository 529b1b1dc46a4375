#include "cli/edit_options.h"

#include <fmt/format.h>

#include "cli/number_checks.h"
#include "core/error.h"
#include "edit/color_names.h"
#include "edit/edit_text.h"
#include "edit/inserted_object.h"
#include "edit/motion_text.h"
#include "edit/selection.h"

namespace aligngs {

namespace {

bool moves_or_copies(const EditOptions& options) {
  return options.duplicate || !options.move.empty() || (!options.turn.empty() && options.replace.empty());
}

/// Number of operations that the options ask for.
int operation_count(const EditOptions& options) {
  return options.remove + options.extract + moves_or_copies(options) + !options.replace.empty() +
         !options.recolor.empty() + !options.highlight.empty();
}

/// With --say everything about the edit is in the sentence.
void require_only_a_sentence(const EditOptions& options) {
  if (operation_count(options) > 0 || options.fill || options.with_contents || options.fit || !options.select.empty() ||
      options.undo || options.list || options.measure) {
    throw_usage("--say is a whole edit by itself", "leave out --select and the operation, or leave out --say");
  }
}

}  // namespace

void require_consistent(const EditOptions& options) {
  if (!options.truth.empty()) {
    if (!options.select.empty() || !options.say.empty() || options.undo || options.list) {
      throw_usage("--truth measures a run that `aligngs edit -o` wrote",
                  "make that run first: aligngs edit RUN --select ... --delete -o NEW_RUN");
    }
    return;
  }
  if (options.objects != "stored" && (!options.measure || !options.select.empty()))
    throw_usage("--objects is for --measure without --select", "add --measure, or leave --objects out");
  const bool says = !options.say.empty();
  if (says) require_only_a_sentence(options);
  const bool renames = !options.rename_selection.empty(), removes = !options.remove_selection.empty();
  const bool looks = options.undo || options.list || says || renames || removes;
  if (options.undo + options.list + options.dry_run + options.measure + renames + removes > 1) {
    throw_usage("--undo, --list, --dry-run, --measure, --rename-selection and --remove-selection exclude each other");
  }
  if ((options.undo || options.list) && (!options.select.empty() || operation_count(options) > 0)) {
    throw_usage(fmt::format("{} is a command of its own", options.undo ? "--undo" : "--list"),
                "leave out the edit here, and make it with another `aligngs edit`");
  }
  if ((renames || removes) && (says || !options.select.empty() || !options.output.empty())) {
    throw_usage("a selection is renamed or removed by itself", "leave out the edit and -o");
  }
  if (!looks && !options.measure && options.select.empty())
    throw_usage("nothing is selected", "say which objects: --select \"pillow, cushion#2\"");
}

EditOperation operation_of(const EditOptions& options) {
  EditOperation edit;
  const bool replaces = !options.replace.empty(), moves = moves_or_copies(options);
  if (operation_count(options) != 1)
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
  const bool of_run = replaces && !is_splat_file(options.replace) && options.replace.find('#') != std::string::npos;
  if (of_run && options.up != "z") {
    throw_usage("--up is for a file of splats: the other run knows which way is up",
                "leave --up out, or give FILE.ply to --replace");
  }
  edit.fill = options.fill || edit.kind == EditKind::kMove || replaces;
  edit.with = options.replace;
  edit.fit = options.fit;
  edit.up_axis = parse_axis(options.up);
  if (!options.move.empty()) edit.motion.shift = parse_shift(options.move);
  if (!options.turn.empty()) edit.motion.turn = parse_turn(options.turn);
  const bool copies_beside = edit.kind == EditKind::kDuplicate && options.move.empty();
  if (moves && !copies_beside) require_motion(edit.motion);
  edit.with_contents = options.with_contents;
  edit.select = options.select;
  edit.threshold = parse_threshold(options.threshold);
  return edit;
}

std::optional<UndoRequest> undo_in_words(const EditOptions& options) {
  if (options.say.empty()) return std::nullopt;
  try {
    return parse_request(options.say).undo;
  } catch (const Error&) {
    return std::nullopt;  // read again with the words of the room, for its suggestions
  }
}

std::shared_ptr<EditOptions> add_edit_options(CLI::App& command) {
  auto options = std::make_shared<EditOptions>();
  command.add_option("run", options->run, "run folder")->required();
  command.add_option("--scene", options->scene, "the scene's new place, if it was moved");
  command
      .add_option("--say", options->say,
                  "the edit in words: \"recolor sofa dark green\", \"delete the pillow on the bed\", \"undo the last "
                  "two edits\"")
      ->group("Edit");
  command
      .add_option("--select", options->select,
                  "objects such as \"pillow, cushion#2\" or \"the tallest lamp next to the bed\", or a selection "
                  "from the page")
      ->group("Selection");
  command.add_option("--threshold", options->threshold, "argmax, auto, or a probability (0 to 1)")
      ->capture_default_str()
      ->group("Selection");
  command.add_flag("--delete", options->remove, "remove the selected objects")->group("Edit");
  command.add_flag("--fill", options->fill, "with --delete: continue the surfaces behind and under the objects")
      ->group("Edit");
  command.add_flag("--with-contents", options->with_contents, "also what is on the objects; not for colours")
      ->group("Edit");
  command.add_flag("--extract", options->extract, "keep the selected objects only")->group("Edit");
  command
      .add_option(
          "--move", options->move,
          "move by RIGHT,UP,TOWARDS in scene units as the photos' cameras see it, e.g. 0.5,0,-0.2; metres in a scene "
          "in metres")
      ->group("Edit");
  command
      .add_option("--turn", options->turn,
                  "turn by degrees, counter-clockwise from above; also with --move and --replace")
      ->group("Edit");
  command.add_flag("--duplicate", options->duplicate, "copy the objects, to the right of them or by --move and --turn")
      ->group("Edit");
  command
      .add_option("--replace", options->replace,
                  "put another object in their place: FILE.ply, or RUN#OBJECT such as other_run#armchair#1")
      ->group("Edit");
  command.add_flag("--fit", options->fit, "with --replace: scale the other object to the box of the old one")
      ->group("Edit");
  command.add_option("--up", options->up, "with --replace FILE.ply: its upward axis, x, y, z, -x, -y or -z")
      ->capture_default_str()
      ->group("Edit");
  command
      .add_option("--recolor", options->recolor,
                  "give the objects this colour, '#rrggbb' or a name; light and texture stay")
      ->group("Edit");
  command.add_option("--highlight", options->highlight, "mix the objects with this colour, '#rrggbb' or a name")
      ->group("Edit");
  command.add_option("-o,--output", options->output, "write a new run instead of editing this one")
      ->group("Stack and output");
  command.add_flag("--dry-run", options->dry_run, "only count, and write a picture of before and after")
      ->group("Stack and output");
  command
      .add_option("--picture", options->picture,
                  "draw a test view before and after the edit into this file (--dry-run: edit_preview.png)")
      ->group("Stack and output");
  command.add_flag("--undo", options->undo, "take the last edit back")->group("Stack and output");
  command.add_option("--wait", options->wait, "seconds to wait for another edit of this run")
      ->check(number_from_zero())
      ->capture_default_str()
      ->group("Stack and output");
  command.add_flag("--list", options->list, "list the edits, the objects of the room and the selections by hand")
      ->group("Selection");
  command
      .add_option("--rename-selection", options->rename_selection,
                  "give a selection that was drawn on the page another name: OLD NEW")
      ->expected(2)
      ->group("Selection");
  command.add_option("--remove-selection", options->remove_selection, "forget a selection that was drawn on the page")
      ->group("Selection");
  command
      .add_option("--truth", options->truth,
                  "compare a run made with -o with a folder SCENE/truth/without/NAME of `synth --without`")
      ->group("Stack and output");
  command
      .add_flag("--measure", options->measure,
                "compare the selection, or without --select every object, with the true ones of the scene (IoU)")
      ->group("Selection");
  command
      .add_option("--objects", options->objects,
                  "with --measure of every object: as stored, or found again by connections or by votes of segments/")
      ->check(CLI::IsMember({"stored", "connected", "votes"}))
      ->capture_default_str()
      ->group("Selection");
  return options;
}

}  // namespace aligngs
