#include "serve/export_file.h"

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "core/log.h"
#include "edit/export/aligned_room.h"
#include "edit/export/chosen_objects.h"
#include "edit/export/followed_room.h"
#include "edit/export/moved_room.h"
#include "gaussians/instances.h"
#include "room/plan/plan_files.h"
#include "room/room_json.h"
#include "scene/scene_json.h"
#include "train/run_folder.h"

namespace aligngs {

const std::vector<RunExportFormat>& run_export_rows() {
  static const std::vector<RunExportFormat> rows = [] {
    std::vector<RunExportFormat> all;
    for (const ExportFormat& room : export_format_rows())
      all.push_back({room.name, room.help, ExportKind::kRoom, &room});
    all.push_back({"html", "one page that opens without a server, with the room inside", ExportKind::kPage});
    for (const PlanFormat& plan : plan_format_rows())
      all.push_back({plan.name, plan.help, ExportKind::kPlan, nullptr, &plan});
    return all;
  }();
  return rows;
}

const std::vector<std::string>& run_export_formats() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const RunExportFormat& format : run_export_rows()) all.emplace_back(format.name);
    return all;
  }();
  return names;
}

const RunExportFormat& run_export_row(const std::string& name) {
  require_export_format(name, run_export_formats());
  const auto& rows = run_export_rows();
  return *std::find_if(rows.begin(), rows.end(), [&](const RunExportFormat& row) { return row.name == name; });
}

namespace {

/// RUN/room.json.
std::optional<MeasuredRoom> room_of(const std::filesystem::path& run) {
  const std::filesystem::path file = run / "room.json";
  return std::filesystem::exists(file) ? std::optional(read_room(file)) : std::nullopt;
}

std::string default_name(const RunExportFormat& format, bool edited) {
  if (format.plan) return format.name;
  const bool of_run = format.room && format.room->of_run;
  return std::string(edited ? "scene.edited." : of_run ? "scene.export." : "scene.") + format.name;
}

/// Error{kUsage} where the file or one beside it would replace a file of the run, or of somebody else.
void require_free(const EditSession& session, const RunExportFormat& format, const std::filesystem::path& file,
                  bool textured) {
  const RunFolder run(session.folder());
  const std::filesystem::path& scene = session.scene().folder;
  run.require_not_of_run(file, scene, format.room ? format.room->beginning : "");
  if (!textured || !format.room) return;
  for (const ExportBeside& beside : format.room->beside)
    run.require_not_of_run(beside.path(file), scene, beside.beginning);
}

/// Scene units.
double millimetre(const EditSession& session) {
  constexpr double kMillimetre = 1e-3;  // metres
  if (const std::optional<double> metres = session.length_unit().metres) return kMillimetre / *metres;
  throw_bad_input(session.folder(), "--error", "an error in millimetres needs a scale, and this run has none",
                  "give it one with aligngs scale, or use --triangles");
}

/// A room to be exported, and the pieces that it was made of.
struct ChosenRoom {
  ChosenRoom(EditSession& session, const RunExportOptions& options)
      : whole(options.original ? session.original() : session.room()) {
    if (!options.object.empty()) chosen = chosen_objects(whole, options.object, session.pool());
  }
  const EditableRoom& room() const { return chosen ? *chosen : whole; }

  const EditableRoom& whole;
  std::optional<EditableRoom> chosen;
};

/// A description of the room as the edits left it; nothing, with a warning where there are edits, for a file of an
/// earlier program.
std::optional<MeasuredRoom> with_edits(EditSession& session, const MeasuredRoom& measured, bool original) {
  if (!session.original().gaussians.has_labels()) return measured;  // no thing has a name or a box
  const EditableRoom& room = original ? session.original() : session.room();
  std::optional<MeasuredRoom> followed = followed_room(measured, session.original(), room, session.pool());
  if (!followed && !session.stack().empty()) {
    log_warning(
        "{} was written by an earlier program, so that its furniture does not follow the edits. Write it again: "
        "aligngs room {}",
        (session.folder() / "room.json").string(), session.folder().string());
  }
  return followed;
}

/// room.json with the edits as text; empty where the page takes the file itself.
std::string edited_room_text(EditSession& session, bool original) {
  if (session.stack().empty() || original) return {};
  try {
    return room_with_edits(session).value_or("");
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kBadInput) throw;
    log_warning("the plan of the page is that of the file: {}", error.what());
    return {};
  }
}

HtmlSceneInfo html_info(const EditSession& session) {
  const std::filesystem::path& run = session.folder();
  HtmlSceneInfo info;
  info.name = std::filesystem::weakly_canonical(run).filename().string();
  info.metric = session.scene().metric;
  info.estimated = session.scene().units_estimate.has_value();
  info.cameras = run / "cameras.json";
  info.room = run / "room.json";
  info.notes = run / "page.json";
  return info;
}

HtmlParts html_parts(const EditSession& session, const RunExportOptions& options, const ChosenRoom& chosen) {
  HtmlParts parts{.room = chosen.room(), .mesh = options.parts != RoomParts::kSplats};
  const bool edited = !options.original && !session.stack().empty() && !chosen.chosen;
  const double trained = static_cast<double>(session.original().gaussians.model.size());
  if (options.before && edited && trained <= kMostBefore * static_cast<double>(parts.room.gaussians.model.size()))
    parts.before = &session.original();
  MeshOptions& mesh = parts.mesh_options;
  mesh.triangles = options.triangles;
  if (options.error > 0) mesh.error = options.error * millimetre(session);
  mesh.closed = options.closed;
  if (!mesh.simplified()) mesh.triangles = kHtmlTriangles;
  return parts;
}

}  // namespace

void refuse_missing_room(const std::filesystem::path& run) {
  throw_bad_input(run / "room.json", "",
                  "this run has no description of its room, of which plans and measures are made",
                  "make it with: aligngs room " + run.string());
}

std::vector<std::string> formats_of_run(const std::filesystem::path& run, bool labels) {
  const bool room = std::filesystem::exists(run / "room.json");
  std::vector<std::string> formats;
  for (const RunExportFormat& format : run_export_rows()) {
    const bool possible = (room || !format.plan) && (labels || !format.room || !format.room->needs_labels);
    if (possible) formats.emplace_back(format.name);
  }
  return formats;
}

RunExport export_run(EditSession& session, const std::string& name, const RunExportOptions& options) {
  const RunExportFormat& format = run_export_row(name);
  RunExport out;
  out.edits = options.original ? 0 : session.stack().size();
  out.file = !options.file.empty() ? options.file : session.folder() / (default_name(format, out.edits > 0));
  require_free(session, format, out.file, options.textured);
  const bool moves = options.coordinates == ExportCoordinates::kRoom && format.kind != ExportKind::kPage;
  const std::optional<MeasuredRoom> measured = moves || format.plan ? room_of(session.folder()) : std::nullopt;
  if (format.plan) {
    if (!measured) refuse_missing_room(session.folder());
    const std::optional<MeasuredRoom> followed = with_edits(session, *measured, options.original);
    if (!followed) out.edits = 0;  // the file does not have them
    const MeasuredRoom& drawn = followed ? *followed : *measured;
    write_plan(out.file, *format.plan, drawn);
    out.report = {.files = {out.file}, .objects = drawn.boxes.size()};
    return out;
  }
  const ChosenRoom chosen(session, options);
  const EditableRoom& room = chosen.room();
  if (format.kind == ExportKind::kPage) {
    const HtmlParts parts = html_parts(session, options, chosen);
    HtmlSceneInfo info = html_info(session);
    info.room_text = edited_room_text(session, options.original);
    const HtmlReport written = write_html(out.file, parts, info, session.pool());
    out.before = parts.before != nullptr;
    out.report = {.files = {out.file},
                  .gaussians = written.gaussians,
                  .objects = list_instances(room.gaussians.model, room.gaussians.labels).size(),
                  .invisible = room.gaussians.model.size() - written.gaussians,
                  .triangles = written.triangles,
                  .triangles_before = written.triangles_before};
    return out;
  }
  out.aligned = moves && measured.has_value();
  const std::filesystem::path scene_json = session.scene().folder / "scene.json";
  const std::optional<Similarity> original_world =
      options.coordinates == ExportCoordinates::kOriginal ? read_scene_json(scene_json).to_original : std::nullopt;
  std::optional<EditableRoom> elsewhere;  // a room that stays is not copied
  Similarity to;
  Vec3d offset;  // of original coordinates that 32-bit floats cannot hold
  if (out.aligned) {
    elsewhere = aligned(without_row_names(room), measured->to_room);
    to = export_frame(measured->to_room);
  } else if (original_world) {
    OffsetRoom original = in_original_coordinates(without_row_names(room), *original_world, scene_json, format.mesh());
    elsewhere = std::move(original.room);
    offset = original.offset;
    to = *original_world;
    to.translation = to.translation - offset;
  }
  if (room.mesh.empty() && (options.triangles > 0 || options.error > 0 || options.closed || options.textured)) {
    throw Error({ErrorKind::kUsage, "there is no mesh to simplify, close or texture", session.folder(), "",
                 "make it first: aligngs mesh RUN"});
  }
  ExportOptions parts{.parts = options.parts};
  if (options.coordinates == ExportCoordinates::kOriginal) parts.offset = offset;
  parts.mesh.triangles = options.triangles;
  parts.mesh.error = options.error > 0 ? options.error * millimetre(session) * to.scale : 0;
  parts.mesh.closed = options.closed;
  parts.mesh.texture_size = options.texture_size;
  const bool textured = options.textured || format.room->texture == ExportTexture::kAlways;
  if (textured && !room.mesh.empty() && options.parts != RoomParts::kSplats) {
    parts.mesh.photos = [&session, to] {
      return moved(load_texture_photos(session.scene(), session.original().mesh, session.pool()), to);
    };
    if (!parts.mesh.simplified()) parts.mesh.triangles = kTexturedTriangles;
  }
  out.report = export_room(elsewhere ? *elsewhere : room, name, out.file, session.pool(), parts);
  return out;
}

HtmlSize estimate_html_export(EditSession& session, const RunExportOptions& options) {
  const ChosenRoom chosen(session, options);
  return estimate_html(html_parts(session, options, chosen), html_info(session));
}

std::optional<std::string> room_with_edits(EditSession& session) {
  const std::optional<MeasuredRoom> measured = room_of(session.folder());
  if (!measured) return std::nullopt;
  return room_json(with_edits(session, *measured, false).value_or(*measured));
}

}  // namespace aligngs
