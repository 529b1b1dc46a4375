#include "edit/export/scene_export.h"

#include <algorithm>

#include "core/edit_distance.h"
#include "core/error.h"

namespace aligngs {

const std::vector<std::string>& export_formats() {
  static const std::vector<std::string> formats = {"ply", "labels.ply", "glb",   "collision.glb", "obj",
                                                   "sog", "spz",        "splat", "usda",          "usdz"};
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

bool holds_splats(const std::string& format) {
  return format != "obj" && format != "usdz" && format != "collision.glb";
}
bool holds_mesh(const std::string& format) {
  return format == "glb" || format == "collision.glb" || format == "obj" || format == "usda" || format == "usdz";
}

void ExportReport::describe(const ExportMesh& mesh) {
  objects = mesh.objects.size();
  triangles = mesh.triangles;
  triangles_before = mesh.triangles_before;
  error = mesh.error;
  open_edges = mesh.open_edges;
}

ExportReport export_room(const EditableRoom& room, const std::string& format, const std::filesystem::path& path,
                         ThreadPool& pool, const ExportOptions& options) {
  const LabelledGaussians& g = room.gaussians;
  if (format == "ply") {
    write_gaussian_ply(path, g.model);
    return {.files = {path}, .gaussians = g.model.size()};
  }
  if (format == "labels.ply") {
    if (!g.has_labels()) {
      throw_bad_input({}, "-f labels.ply", "this run was trained without semantics: there are no labels",
                      "export another format, or train a scene that has segmentation_logits/");
    }
    write_labelled_gaussian_ply(path, g.model, g.labels);
    return {.files = {path}, .gaussians = g.model.size(), .objects = list_instances(g.model, g.labels).size()};
  }
  if (format == "glb") return write_glb(path, room, pool, options);
  if (format == "collision.glb") return write_collision_glb(path, room, pool, options);
  if (format == "usda") return write_usda(path, room, pool, options);
  if (format == "usdz") return write_usdz(path, room, pool, options);
  if (format == "obj") return write_obj(path, room, pool, options);
  if (format == "sog") return write_sog(path, g.model, pool);
  if (format == "spz") return write_spz(path, g.model);
  if (format == "splat") return write_splat(path, g.model);
  require_export_format(format);
  return {};
}

}  // namespace aligngs
