#include "serve/export_file.h"

#include "gaussians/instances.h"
#include "serve/html_export.h"
#include "train/run_folder.h"

namespace aligngs {

const std::vector<std::string>& run_export_formats() {
  static const std::vector<std::string> formats = [] {
    std::vector<std::string> all = export_formats();
    all.push_back("html");
    return all;
  }();
  return formats;
}

namespace {

/// scene.ply and scene.labels.ply are the run's own.
std::string default_name(const std::string& format, bool edited) {
  const bool own = format == "ply" || format == "labels.ply";
  return (edited ? "scene.edited." : own ? "scene.export." : "scene.") + format;
}

}  // namespace

RunExport export_run(EditSession& session, const std::string& format, bool original, const std::filesystem::path& file, RoomParts parts) {
  require_export_format(format, run_export_formats());
  RunExport out;
  out.edits = original ? 0 : session.stack().size();
  out.file = !file.empty() ? file : session.folder() / (default_name(format, out.edits > 0));
  RunFolder(session.folder()).require_not_of_run(out.file, session.scene().folder);
  const EditableRoom& room = original ? session.original() : session.room();
  if (format == "html") {
    HtmlSceneInfo info;
    info.name = std::filesystem::weakly_canonical(session.folder()).filename().string();
    info.metric = session.scene().metric;
    info.cameras = session.folder() / "cameras.json";
    write_html(out.file, room, info);
    out.report = {{out.file}, room.gaussians.model.size(), list_instances(room.gaussians.model, room.gaussians.labels).size()};
  } else {
    out.report = export_room(room, format, out.file, session.pool(), parts);
  }
  return out;
}

}  // namespace aligngs
