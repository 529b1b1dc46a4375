#include "edit/export/scene_export.h"

#include <algorithm>

#include "core/edit_distance.h"
#include "core/error.h"
#include "core/log.h"

namespace aligngs {

namespace {

ExportReport write_ply_export(const std::filesystem::path& path, const EditableRoom& room, ThreadPool&,
                              const ExportOptions&) {
  write_gaussian_ply(path, room.gaussians.model);
  return {.files = {path}, .gaussians = room.gaussians.model.size()};
}

ExportReport write_labels_export(const std::filesystem::path& path, const EditableRoom& room, ThreadPool&,
                                 const ExportOptions&) {
  const LabelledGaussians& g = room.gaussians;
  if (!g.has_labels()) {
    throw_bad_input({}, "-f labels.ply", "this run was trained without semantics: there are no labels",
                    "export another format, or train a scene that has segmentation_logits/");
  }
  write_labelled_gaussian_ply(path, g.model, g.labels);
  return {.files = {path}, .gaussians = g.model.size(), .objects = list_instances(g.model, g.labels).size()};
}

ExportReport write_sog_export(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                              const ExportOptions&) {
  return write_sog(path, room.gaussians.model, pool);
}

ExportReport write_spz_export(const std::filesystem::path& path, const EditableRoom& room, ThreadPool&,
                              const ExportOptions&) {
  const std::string coarse = coarse_spz_warning(room.gaussians.model, room.gaussians.extent);
  if (!coarse.empty()) log_warning("{}: {}", path.string(), coarse);
  return write_spz(path, room.gaussians.model);
}

ExportReport write_splat_export(const std::filesystem::path& path, const EditableRoom& room, ThreadPool&,
                                const ExportOptions&) {
  return write_splat(path, room.gaussians.model);
}

/// Null without one of that name.
const ExportFormat* find_format(const std::string& name) {
  for (const ExportFormat& format : export_format_rows()) {
    if (name == format.name) return &format;
  }
  return nullptr;
}

}  // namespace

const std::vector<ExportFormat>& export_format_rows() {
  static const std::vector<ExportFormat> rows = {
      {.name = "ply",
       .title = "PLY",
       .help = "splats in the standard layout of 3DGS",
       .splats = true,
       .write = write_ply_export,
       .of_run = true},
      {.name = "labels.ply",
       .title = "PLY",
       .help = "splats with class, object and confidence",
       .splats = true,
       .write = write_labels_export,
       .needs_labels = true,
       .of_run = true},
      {.name = "glb",
       .title = "GLB",
       .help = "a node per object, and the splats",
       .splats = true,
       .mesh = true,
       .write = write_glb,
       .one_part = true,
       .texture = ExportTexture::kAsked},
      {.name = "collision.glb",
       .title = "GLB",
       .help = "the mesh for physics",
       .mesh = true,
       .write = write_collision_glb},
      {.name = "obj",
       .title = "OBJ",
       .help = "the mesh with a group per object",
       .mesh = true,
       .write = write_obj,
       .texture = ExportTexture::kAsked,
       .beginning = "# aligngs ",
       .beside = {{texture_beside}, {material_beside, kMaterialBeginning}}},
      {.name = "sog",
       .title = "SOG",
       .help = "compressed splats of PlayCanvas",
       .splats = true,
       .write = write_sog_export},
      {.name = "spz",
       .title = "SPZ",
       .help = "compressed splats of Niantic",
       .splats = true,
       .write = write_spz_export},
      {.name = "splat",
       .title = "splat",
       .help = "splats of 32 bytes each",
       .splats = true,
       .write = write_splat_export},
      {.name = "usda",
       .title = "USD",
       .help = "USD with a prim per object: label, splats, mesh and collider",
       .splats = true,
       .mesh = true,
       .write = write_usda,
       .one_part = true,
       .texture = ExportTexture::kAsked,
       .beginning = "#usda 1.0\n(\n    defaultPrim = \"room\"\n    doc = \"aligngs ",
       .beside = {{texture_beside}}},
      {.name = "usdz",
       .title = "USD",
       .help = "the mesh with a texture, for phones",
       .mesh = true,
       .write = write_usdz,
       .texture = ExportTexture::kAlways}};
  return rows;
}

const std::vector<std::string>& export_formats() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const ExportFormat& format : export_format_rows()) all.emplace_back(format.name);
    return all;
  }();
  return names;
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

void ExportReport::describe(const ExportMesh& mesh) {
  objects = mesh.objects.size();
  triangles = mesh.triangles;
  triangles_before = mesh.triangles_before;
  error = mesh.error;
  open_edges = mesh.open_edges;
}

std::filesystem::path texture_beside(const std::filesystem::path& path) {
  return std::filesystem::path(path).replace_extension(".jpg");
}

std::filesystem::path material_beside(const std::filesystem::path& path) {
  return std::filesystem::path(path).replace_extension(".mtl");
}

ExportReport export_room(const EditableRoom& room, const std::string& format, const std::filesystem::path& path,
                         ThreadPool& pool, const ExportOptions& options) {
  require_export_format(format);
  return find_format(format)->write(path, room, pool, options);
}

}  // namespace aligngs
