#include "edit/export/scene_export.h"

#include <algorithm>

#include "core/edit_distance.h"
#include "core/error.h"

namespace aligngs {

const std::vector<std::string>& export_formats() {
  static const std::vector<std::string> formats = {"ply", "labels.ply", "glb", "obj", "sog", "spz", "splat", "usda"};
  return formats;
}

void require_export_format(const std::string& format, const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), format) != known.end()) return;
  std::string list, near;
  for (const std::string& f : known) {
    list += (list.empty() ? "" : ", ") + f;
    if (edit_distance(f, format) <= 1) near = f;
  }
  throw_usage("there is no export format \"" + format.substr(0, 40) + "\"",
              (near.empty() ? "" : "did you mean " + near + "? ") + "formats: " + list);
}

ExportReport export_room(const EditableRoom& room, const std::string& format, const std::filesystem::path& path,
                         ThreadPool& pool, RoomParts parts) {
  const LabelledGaussians& g = room.gaussians;
  if (format == "ply") {
    write_gaussian_ply(path, g.model);
    return {{path}, g.model.size(), 0};
  }
  if (format == "labels.ply") {
    if (!g.has_labels()) {
      throw_bad_input({}, "-f labels.ply", "this run was trained without semantics: there are no labels",
                      "export another format, or train a scene that has segmentation_logits/");
    }
    write_labelled_gaussian_ply(path, g.model, g.labels);
    return {{path}, g.model.size(), list_instances(g.model, g.labels).size()};
  }
  if (format == "glb") return write_glb(path, room, pool, parts);
  if (format == "usda") return write_usda(path, room, pool, parts);
  if (format == "obj") return write_obj(path, room, pool);
  if (format == "sog") return write_sog(path, g.model, pool);
  if (format == "spz") return write_spz(path, g.model);
  if (format == "splat") return write_splat(path, g.model);
  require_export_format(format);
  return {};
}

}  // namespace aligngs
