#include "edit/apply_edit.h"

#include <algorithm>
#include <utility>

#include "core/append.h"
#include "core/error.h"
#include "core/kept_rows.h"
#include "edit/absent_objects.h"
#include "edit/contents.h"
#include "edit/crumbs.h"
#include "edit/export/moved_room.h"
#include "edit/fill/fill_removed.h"
#include "edit/meant_objects.h"
#include "edit/mesh_rows.h"
#include "edit/mesh_selection.h"
#include "edit/move_objects.h"
#include "edit/object_names.h"
#include "edit/object_parts.h"
#include "edit/out_of_room.h"
#include "edit/placement_warnings.h"
#include "edit/recolor.h"
#include "edit/replace_object.h"
#include "edit/row_flags.h"
#include "edit/taken_objects.h"
#include "gaussians/restructure.h"

namespace aligngs {
namespace {

void append_patch(EditableRoom& room, const SupportPatch& patch) {
  GaussianModel& m = room.gaussians.model;
  const GaussianModel& p = patch.gaussians;
  append(m.positions, p.positions);
  append(m.log_scales, p.log_scales);
  append(m.rotations, p.rotations);
  append(m.opacity_logits, p.opacity_logits);
  append(m.sh, p.sh);
  append(m.semantics, p.semantics);
  for (const uint32_t source : patch.sources) {
    GaussianLabels& l = room.gaussians.labels;
    l.label.push_back(l.label[source]);
    l.instance.push_back(l.instance[source]);
    l.confidence.push_back(l.confidence[source]);
    for (size_t k = 0; !room.gaussians.soft.label.empty() && k < SoftLabels::kTop; ++k) {
      room.gaussians.soft.label.push_back(room.gaussians.soft.label[SoftLabels::kTop * source + k]);
      room.gaussians.soft.probability.push_back(room.gaussians.soft.probability[SoftLabels::kTop * source + k]);
    }
    room.origins.push_back({room.origins[source].row, true});
  }
}

void keep_part(EditableRoom& room, const std::vector<uint8_t>& keep, const std::vector<uint8_t>& vertices,
               uint8_t value) {
  room.gaussians = keep_rows(std::move(room.gaussians), keep);
  room.origins = kept_rows(room.origins, keep, 1);
  keep_mesh(room, vertices, value);
}

/// Gaussians that a deletion leaves of objects that it takes for the most part: specks inside of other things.
std::vector<uint8_t> rest_of_objects(const LabelledGaussians& room, const std::vector<uint8_t>& mask) {
  const TakenObjects taken(room.labels, mask);
  std::vector<uint8_t> rest(mask.size(), 0);
  for (size_t i = 0; i < mask.size(); ++i) rest[i] = !mask[i] && taken.holds_row(i);
  return rest;
}

std::vector<uint8_t> with(std::vector<uint8_t> flags, const std::vector<uint8_t>& more) {
  for (size_t i = 0; i < flags.size(); ++i) flags[i] |= more[i];
  return flags;
}

void remove_objects(EditableRoom& room, const EditOperation& edit, const std::vector<uint8_t>& mask,
                    std::vector<uint8_t> vertices, EditReport& report, ThreadPool& pool) {
  std::vector<SupportPatch> patches;
  std::vector<uint8_t> gone = mask, rest = rest_of_objects(room.gaussians, mask);
  if (edit.fill) {
    Filling filling = fill_removed({room.gaussians, room.labels, mask, room.up, room.cameras, &pool});
    patches = std::move(filling.patches);
    report.no_support = patches.empty();
    report.cleared = static_cast<size_t>(std::count(filling.debris.begin(), filling.debris.end(), uint8_t(1)));
    gone = with(std::move(gone), filling.debris);
    if (report.cleared) vertices = select_vertices(room.mesh, room.gaussians.model, gone, room.gaussians.extent, pool);
    gone = with(std::move(gone), filling.shaded);
    append_patch(room, filling.lighter);
    gone.resize(room.gaussians.model.size(), 0);
  }
  std::vector<uint8_t> keep = inverted(gone);
  for (const SupportPatch& patch : patches) {
    report.filled += patch.sources.size();
    append_patch(room, patch);  // before rows move: the sources are rows of the room as it is
  }
  keep.resize(room.gaussians.model.size(), 1);
  rest.resize(room.gaussians.model.size(), 0);
  keep_part(room, keep, vertices, 0);
  CrumbOptions joining;
  joining.majority = 0;  // nothing may stay of an object that is gone
  RoomTree tree(room.gaussians.model);
  join_neighbours(room.gaussians, kept_rows(rest, keep, 1), joining, pool, {}, &tree);
  join_crumbs(room.gaussians, {}, pool, &tree);
  for (const SupportPatch& patch : patches) {
    if (!room.mesh.vertices.empty()) append_mesh(room, patch.mesh);
  }
}

/// The object that most of a piece is of; several ones have no name.
std::string name_of(const EditableRoom& room, const EditableRoom& piece) {
  const std::vector<Instance> objects = list_instances(piece.gaussians.model, piece.gaussians.labels);
  const auto largest = std::max_element(objects.begin(), objects.end(),
                                        [](const Instance& a, const Instance& b) { return a.gaussians < b.gaussians; });
  return largest != objects.end() ? object_name(*largest, room.labels) : "the object";
}

void warn_of_place(const EditableRoom& room, const std::vector<uint8_t>& mask, const Placement& placement,
                   EditReport& report) {
  if (const std::string out = out_of_room(room, mask, placement); !out.empty()) report.warnings.push_back(out);
  append(report.warnings, placement_warnings(room, mask, placement));
}

void move_objects(EditableRoom& room, const EditOperation& edit, const std::vector<uint8_t>& mask,
                  const std::vector<uint8_t>& vertices, EditReport& report, ThreadPool& pool) {
  EditableRoom piece = piece_of(room, mask, vertices);
  claim_neighbours(piece, room);
  ObjectMotion motion = edit.motion;
  // A turned copy steps aside, too.
  if (edit.kind == EditKind::kDuplicate && motion.stays_in_place()) motion.shift.x = step_aside(room, mask);
  const Similarity to = motion_in_world(room, mask, motion);
  if (edit.kind == EditKind::kDuplicate) number_anew(piece, room);
  Placement placement{name_of(room, piece), solid_places(room.gaussians.model, mask), {}, edit.kind != EditKind::kMove};
  for (const Vec3d& place : placement.before) placement.after.push_back(to * place);
  warn_of_place(room, mask, placement, report);
  if (edit.kind == EditKind::kMove) remove_objects(room, edit, mask, vertices, report, pool);
  add_piece(room, moved(piece, to));
}

void replace_objects(EditableRoom& room, const EditOperation& edit, const std::vector<uint8_t>& mask,
                     const std::vector<uint8_t>& vertices, EditReport& report, ThreadPool& pool) {
  if (!edit.object) throw Error({ErrorKind::kFailed, "the object of a replacement was not read", {}, "--replace", {}});
  const Similarity to = placement_of(room, mask, *edit.object, edit.motion.turn, edit.fit);
  const EditableRoom piece = labelled_for(room, mask, *edit.object);
  const GaussianModel& model = piece.gaussians.model;
  Placement placement{name_of(room, piece), solid_places(room.gaussians.model, mask),
                      solid_places(model, std::vector<uint8_t>(model.size(), 1)), false};
  for (Vec3d& place : placement.after) place = to * place;
  warn_of_place(room, mask, placement, report);
  remove_objects(room, edit, mask, vertices, report, pool);
  add_piece(room, moved(piece, to));
  const GaussianLabels& labels = piece.gaussians.labels;
  report.inserted = labels.label.size();
  report.inserted_triangles = piece.mesh.triangles.size();
  report.replacement = {labels.label[0] == kNoLabel ? -1 : labels.label[0], labels.instance[0], report.inserted};
}

std::optional<Vec3d> mean_place(const std::vector<Camera>& cameras) {
  if (cameras.empty()) return std::nullopt;
  Vec3d sum;
  for (const Camera& camera : cameras) sum += camera.centre();
  return sum * (1.0 / static_cast<double>(cameras.size()));
}

/// One entry for each object: neighbours of a selection are in it before their whole object is.
std::vector<SelectedObject> merged(const std::vector<SelectedObject>& objects) {
  std::vector<SelectedObject> out;
  for (const SelectedObject& o : objects) {
    const auto same = std::find_if(out.begin(), out.end(), [&](const SelectedObject& other) {
      return other.label == o.label && other.instance == o.instance;
    });
    if (same == out.end()) {
      out.push_back(o);
    } else {
      same->gaussians = std::max(same->gaussians, o.gaussians);
    }
  }
  return out;
}

/// Things on the selected objects: selected, too, or named in the report.
void add_contents(const EditableRoom& room, bool take, GaussianSelection& selection, EditReport& report) {
  const std::vector<Instance> contents = contents_of(room.gaussians, selection.mask, room.labels, *room.up);
  std::vector<SelectedObject>& list = take ? selection.objects : report.contents;
  for (const Instance& o : contents) list.push_back({o.label, o.number, o.gaussians});
  if (!take) return;
  select_objects(room.gaussians, contents, selection.mask);
  selection.count = static_cast<size_t>(std::count(selection.mask.begin(), selection.mask.end(), uint8_t(1)));
}

/// Things that belong to the selected objects: selected, too. "The plant without the pot" leaves the pot.
void add_parts(const EditableRoom& room, const SelectionQuery& query, GaussianSelection& selection,
               EditReport& report) {
  std::vector<Instance> parts = parts_of(room.gaussians, selection.mask, room.labels, room.up);
  std::erase_if(parts, [&](const Instance& part) {
    return std::any_of(query.exclude.begin(), query.exclude.end(), [&](const SelectionTerm& term) {
      return term.label == part.label && (term.instance == 0 || term.instance == part.number);
    });
  });
  if (parts.empty()) return;
  for (const Instance& o : parts) report.parts.push_back({o.label, o.number, o.gaussians});
  select_objects(room.gaussians, parts, selection.mask);
  selection.objects.insert(selection.objects.end(), report.parts.begin(), report.parts.end());
  selection.count = static_cast<size_t>(std::count(selection.mask.begin(), selection.mask.end(), uint8_t(1)));
}

}  // namespace

LabelledGaussians keep_rows(LabelledGaussians room, const std::vector<uint8_t>& keep) {
  restructure_model(plan_keep(keep), room.model);
  if (!room.soft.label.empty()) {
    room.soft.label = kept_rows(room.soft.label, keep, SoftLabels::kTop);
    room.soft.probability = kept_rows(room.soft.probability, keep, SoftLabels::kTop);
  }
  room.labels.label = kept_rows(room.labels.label, keep, 1);
  room.labels.instance = kept_rows(room.labels.instance, keep, 1);
  room.labels.confidence = kept_rows(room.labels.confidence, keep, 1);
  return room;
}

Vocabulary vocabulary_of(const EditableRoom& room) {
  Vocabulary vocabulary(room.labels);
  std::vector<int> present;
  for (const Instance& object : list_instances(room.gaussians.model, room.gaussians.labels))
    present.push_back(object.label);
  vocabulary.prefer(present);
  for (const NamedSelection& s : room.selections ? room.selections->list : std::vector<NamedSelection>())
    vocabulary.add_selection(s.name);
  return vocabulary;
}

SelectionQuery read_selection(const EditableRoom& room, const std::string& text) {
  SelectionQuery query = with_rows(parse_selection(text, vocabulary_of(room)), room);
  if (!asks_objects(query)) return query;
  // About 3 m is the extent of a room whose scale is not known.
  const double metre = room.metric ? 1 : room.gaussians.extent / 3;
  return with_numbers(std::move(query),
                      RoomObjects(room.gaussians, room.labels, {room.up, mean_place(room.cameras)}, metre));
}

EditReport apply_edit(EditableRoom& room, const EditOperation& edit, ThreadPool& pool) {
  const SelectionQuery query = read_selection(room, edit.select);
  SelectionOptions options;
  // The rest of a deleted object shows against the hole, so that half of the neighbours suffice to go with it.
  if (leaves_hole(edit.kind)) options.join = 0.5;
  GaussianSelection selection = select_gaussians(room.gaussians, query, edit.threshold, room.labels, options, pool);
  EditReport report;
  if (!takes_color(edit.kind) && !query.everything) add_parts(room, query, selection, report);
  if ((leaves_hole(edit.kind) || edit.with_contents) && room.up && !query.everything) {
    add_contents(room, edit.with_contents, selection, report);
  }
  report.description = describe(edit);
  report.objects = merged(selection.objects);
  if (edit.threshold.kind == ThresholdRule::Kind::kArgmax)
    report.absent = absent_names(list_instances(room.gaussians.model, room.gaussians.labels), query, room.labels);
  report.selected = selection.count;
  report.threshold = selection.threshold;
  report.asked_everything = query.everything;
  report.asked = classes_named(query.include, room);
  report.before = room.gaussians.model.size();
  report.vertices_before = room.mesh.vertices.size();
  if (leaves_hole(edit.kind) && selection.count == report.before) {
    const char* why = edit.kind == EditKind::kMove      ? "nothing else remains that could hold what moves"
                      : edit.kind == EditKind::kReplace ? "nothing would remain around the new object"
                                                        : "nothing would be left";
    throw_bad_input({}, "--select", std::string(why) + ": the selection is the whole room", "select less");
  }
  const std::vector<uint8_t> vertices =
      select_vertices(room.mesh, room.gaussians.model, selection.mask, room.gaussians.extent, pool);
  report.selected_vertices = static_cast<size_t>(std::count(vertices.begin(), vertices.end(), uint8_t(1)));
  switch (edit.kind) {
    case EditKind::kDelete:
      remove_objects(room, edit, selection.mask, vertices, report, pool);
      break;
    case EditKind::kMove:
    case EditKind::kDuplicate:
      move_objects(room, edit, selection.mask, vertices, report, pool);
      break;
    case EditKind::kReplace:
      replace_objects(room, edit, selection.mask, vertices, report, pool);
      break;
    case EditKind::kExtract:
      keep_part(room, selection.mask, vertices, 1);
      break;
    case EditKind::kRecolor:
      report.mean_luma = mean_luma(room.gaussians.model, selection.mask);
      if (report.mean_luma) recolor_gaussians(room.gaussians.model, selection.mask, edit.color, *report.mean_luma);
      recolor_vertices(room.mesh, vertices, edit.color);
      break;
    case EditKind::kHighlight:
      highlight_gaussians(room.gaussians.model, selection.mask, edit.color);
      highlight_vertices(room.mesh, vertices, edit.color);
      break;
  }
  if (edit.kind == EditKind::kHighlight || report.mean_luma) report.recolored = std::move(selection.mask);
  report.after = room.gaussians.model.size();
  report.vertices_after = room.mesh.vertices.size();
  return report;
}

}  // namespace aligngs
