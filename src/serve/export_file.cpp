#include "serve/export_file.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "core/error.h"
#include "edit/export/aligned_room.h"
#include "edit/export/chosen_objects.h"
#include "edit/export/moved_room.h"
#include "gaussians/instances.h"
#include "room/plan/plan_files.h"
#include "room/room_json.h"
#include "scene/scene_json.h"
#include "train/run_folder.h"

namespace aligngs {

const std::vector<std::string>& run_export_formats() {
  static const std::vector<std::string> formats = [] {
    std::vector<std::string> all = export_formats();
    all.push_back("html");
    all.insert(all.end(), plan_formats().begin(), plan_formats().end());
    return all;
  }();
  return formats;
}

namespace {

bool is_plan(const std::string& format) {
  return std::find(plan_formats().begin(), plan_formats().end(), format) != plan_formats().end();
}

/// RUN/room.json.
std::optional<MeasuredRoom> room_of(const std::filesystem::path& run) {
  const std::filesystem::path file = run / "room.json";
  return std::filesystem::exists(file) ? std::optional(read_room(file)) : std::nullopt;
}

/// scene.ply and scene.labels.ply are the run's own.
std::string default_name(const std::string& format, bool edited) {
  if (is_plan(format)) return format;
  const bool own = format == "ply" || format == "labels.ply";
  return (edited ? "scene.edited." : own ? "scene.export." : "scene.") + format;
}

/// How files of a format begin, where all that this program writes begin alike; else empty.
std::string_view beginning_of(const std::string& format) {
  if (format == "obj") return "# aligngs ";
  if (format == "usda") return "#usda 1.0\n(\n    defaultPrim = \"room\"\n    doc = \"aligngs ";
  return {};
}

/// Error{kUsage} where the file or one beside it would replace a file of the run, or of somebody else.
void require_free(const EditSession& session, const std::string& format, const std::filesystem::path& file,
                  bool textured) {
  const RunFolder run(session.folder());
  const std::filesystem::path& scene = session.scene().folder;
  run.require_not_of_run(file, scene, beginning_of(format));
  if (!textured) return;
  run.require_not_of_run(texture_beside(file), scene);
  if (format == "obj") run.require_not_of_run(material_beside(file), scene, kMaterialBeginning);
}

/// Scene units.
double millimetre(const EditSession& session) {
  constexpr double kMillimetre = 1e-3;  // metres
  if (const std::optional<double> metres = session.metres_of_unit()) return kMillimetre / *metres;
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

HtmlSceneInfo html_info(const EditSession& session) {
  const std::filesystem::path& run = session.folder();
  HtmlSceneInfo info;
  info.name = std::filesystem::weakly_canonical(run).filename().string();
  info.metric = session.scene().metric;
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

std::vector<std::string> formats_of_run(const std::filesystem::path& run) {
  std::vector<std::string> formats = run_export_formats();
  if (!std::filesystem::exists(run / "room.json")) std::erase_if(formats, is_plan);
  return formats;
}

RunExport export_run(EditSession& session, const std::string& format, const RunExportOptions& options) {
  require_export_format(format, run_export_formats());
  RunExport out;
  out.edits = options.original ? 0 : session.stack().size();
  out.file = !options.file.empty() ? options.file : session.folder() / (default_name(format, out.edits > 0));
  require_free(session, format, out.file, options.textured && (format == "obj" || format == "usda"));
  const bool moves = options.coordinates == ExportCoordinates::kRoom && format != "html";
  const std::optional<MeasuredRoom> measured = moves || is_plan(format) ? room_of(session.folder()) : std::nullopt;
  if (is_plan(format)) {
    if (!measured) refuse_missing_room(session.folder());
    write_plan(out.file, format, *measured);
    out.report = {.files = {out.file}, .objects = measured->boxes.size()};
    return out;
  }
  const ChosenRoom chosen(session, options);
  const EditableRoom& room = chosen.room();
  if (format == "html") {
    const HtmlParts parts = html_parts(session, options, chosen);
    const HtmlReport written = write_html(out.file, parts, html_info(session), session.pool());
    out.before = parts.before != nullptr;
    out.report = {.files = {out.file},
                  .gaussians = room.gaussians.model.size(),
                  .objects = list_instances(room.gaussians.model, room.gaussians.labels).size(),
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
    OffsetRoom original =
        in_original_coordinates(without_row_names(room), *original_world, scene_json, holds_mesh(format));
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
  if ((options.textured || format == "usdz") && !room.mesh.empty() && options.parts != RoomParts::kSplats) {
    parts.mesh.photos = [&session, to] {
      return moved(load_texture_photos(session.scene(), session.original().mesh, session.pool()), to);
    };
    if (!parts.mesh.simplified()) parts.mesh.triangles = kTexturedTriangles;
  }
  out.report = export_room(elsewhere ? *elsewhere : room, format, out.file, session.pool(), parts);
  return out;
}

HtmlSize estimate_html_export(EditSession& session, const RunExportOptions& options) {
  const ChosenRoom chosen(session, options);
  return estimate_html(html_parts(session, options, chosen), html_info(session));
}

}  // namespace aligngs
