#include "serve/export_file.h"

#include "gaussians/instances.h"
#include "serve/html_export.h"

namespace aligngs {

const std::vector<std::string>& run_export_formats() {
  static const std::vector<std::string> formats = [] {
    std::vector<std::string> all = export_formats();
    all.push_back("html");
    return all;
  }();
  return formats;
}

RunExport export_run(EditSession& session, const std::string& format, bool original, const std::filesystem::path& file) {
  require_export_format(format, run_export_formats());
  RunExport out;
  out.edits = original ? 0 : session.stack().size();
  out.file = !file.empty() ? file : session.folder() / ((out.edits > 0 ? "scene.edited." : "scene.") + format);
  const EditableRoom& room = original ? session.original() : session.room();
  if (format == "html") {
    HtmlSceneInfo info;
    info.name = std::filesystem::weakly_canonical(session.folder()).filename().string();
    info.metric = session.scene().metric;
    info.cameras = session.folder() / "cameras.json";
    write_html(out.file, room, info);
    out.report = {{out.file}, room.gaussians.model.size(), list_instances(room.gaussians.model, room.gaussians.labels).size()};
  } else {
    out.report = export_room(room, format, out.file, session.pool());
  }
  return out;
}

}  // namespace aligngs
