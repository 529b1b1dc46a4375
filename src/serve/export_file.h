// Exports of a run by format name: those of the edits module and the self-contained page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "edit/edit_session.h"
#include "edit/export/scene_export.h"

namespace aligngs {

/// "ply", "labels.ply", "glb", "obj", "sog", "spz", "splat", "html".
const std::vector<std::string>& run_export_formats();

struct RunExport {
  std::filesystem::path file;
  ExportReport report;
  size_t edits = 0;  ///< of the run's stack that the file has
};

/// Writes the room of a session, with its edits unless `original`. An empty `file` means scene.<format> in the run
/// (scene.export.ply and scene.export.labels.ply: those without "export" are the run's own), or scene.edited.<format> for an
/// edited room. Error{kUsage} for a file of the run or its scene, and errors as export_room's.
RunExport export_run(EditSession& session, const std::string& format, bool original, const std::filesystem::path& file,
                     RoomParts parts = RoomParts::kAll);

}  // namespace aligngs
