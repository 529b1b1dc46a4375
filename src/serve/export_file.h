// Exports of a run by format name: those of the edits module, the self-contained page, and the floor plans.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "edit/edit_session.h"
#include "edit/export/scene_export.h"
#include "room/plan/plan_files.h"
#include "serve/html_export.h"

namespace aligngs {

/// The making of a file.
enum class ExportKind {
  kRoom,  ///< splats and mesh, for other programs
  kPage,  ///< the page with the room inside
  kPlan   ///< drawn from room.json
};

/// A format of `aligngs export` as a row.
struct RunExportFormat {
  const char* name;
  const char* help;  ///< what the file has, one line
  ExportKind kind;
  const ExportFormat* room = nullptr;  ///< of kRoom
  const PlanFormat* plan = nullptr;    ///< of kPlan

  /// A page holds both.
  bool splats() const { return kind == ExportKind::kPage || (room && room->splats); }
  bool mesh() const { return kind == ExportKind::kPage || (room && room->mesh); }
};
/// The formats of a room, then the page, then the plans.
const std::vector<RunExportFormat>& run_export_rows();
/// Their names.
const std::vector<std::string>& run_export_formats();
/// The row of a name. Error{kUsage} with a suggestion where there is none.
const RunExportFormat& run_export_row(const std::string& format);
/// The names of those that a run can have: plans where it has room.json, labels where its Gaussians have them.
std::vector<std::string> formats_of_run(const std::filesystem::path& run, bool labels);

/// Error{kBadInput} always: the run has no room.json. The remedy is `aligngs room`.
[[noreturn]] void refuse_missing_room(const std::filesystem::path& run);

/// The world of an exported room.
enum class ExportCoordinates {
  kRoom,      ///< of room.json if the run has one, else the scene's
  kScene,     ///< the scene's own
  kOriginal,  ///< of the files that the scene was imported from: to_original of scene.json, else the scene's own
};

/// Triangles of a mesh with a texture, where no other limit is given.
inline constexpr size_t kTexturedTriangles = 100000;
/// Triangles of the mesh of an exported page, where no other limit is given: about half a megabyte.
inline constexpr size_t kHtmlTriangles = 100000;
/// An exported page has the room before its edits when that has at most this many times as many splats.
inline constexpr double kMostBefore = 1.5;

struct RunExportOptions {
  bool original = false;       ///< without the edits of the run
  std::filesystem::path file;  ///< empty: a name in the run
  RoomParts parts = RoomParts::kAll;
  ExportCoordinates coordinates = ExportCoordinates::kRoom;
  std::string object;       ///< a selection: only these objects; empty: the room
  size_t triangles = 0;     ///< of the mesh, at most; 0: no limit
  double error = 0;         ///< millimetres that the surface of the mesh may move; 0: no limit
  bool closed = false;      ///< close the holes of the mesh
  bool textured = false;    ///< a texture from the photos; always for usdz
  int texture_size = 4096;  ///< pixels, side of the texture at most
  bool before = true;       ///< html: the room before its edits, too, where that is cheap (kMostBefore)
};

struct RunExport {
  std::filesystem::path file;
  ExportReport report;
  size_t edits = 0;      ///< of the run's stack that the file has
  bool aligned = false;  ///< the file is in the room's own frame
  bool before = false;   ///< html: the file has the room before its edits, too
};

/// Writes the room of a session. The default file is scene.<format> in the run,
/// scene.edited.<format> for an edited room, and RUN/<format> for a plan. PLY files are scene.export.ply and
/// scene.export.labels.ply: those without "export" are the run's own. If the run has room.json, splats and meshes are
/// in the room's own frame (edit/export/aligned_room.h). `coordinates` may ask for others; the page of html keeps the
/// cameras' frame. Error{kBadInput} for a plan without room.json, and for original coordinates that the files cannot
/// hold (in_original_coordinates). Error{kUsage} for options of a mesh where there is none. Error{kBadInput} for an
/// error in millimetres where no scale is known. Error{kUsage} for a file of the run or its scene, and errors as
/// export_room's and chosen_objects'.
RunExport export_run(EditSession& session, const std::string& format, const RunExportOptions& options = {});

/// Size that export_run's html would have, before it is written. Errors as export_run's.
HtmlSize estimate_html_export(EditSession& session, const RunExportOptions& options = {});

/// room.json of a run with its edits as text; that of the file where its furniture cannot follow them. Nothing without a
/// room.json. Error{kBadInput} for a damaged one.
std::optional<std::string> room_with_edits(EditSession& session);

}  // namespace aligngs
