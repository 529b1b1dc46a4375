#include <fmt/format.h>

#include "core/error.h"
#include "core/version.h"
#include "edit/export/scene_export.h"
#include "edit/export/upright.h"
#include "io/atomic_file.h"
#include "io/drawn_picture.h"

namespace aligngs {
namespace {

/// Beside the file: its texture, and the material that names it. Unlit (illum 0): the photos' light is in the colours.
void write_material(const std::filesystem::path& path, const Image<uint8_t>& texture, ExportReport& report) {
  const std::filesystem::path picture = texture_beside(path), library = material_beside(path);
  write_drawn_jpeg(picture, texture, kTextureQuality);
  write_file_atomically(library, std::string(kMaterialBeginning) + "map_Kd " + picture.filename().string() + "\n");
  report.files.push_back(library);
  report.files.push_back(picture);
}

}  // namespace

ExportReport write_obj(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                       const ExportOptions& options) {
  if (room.mesh.empty())
    throw Error(
        {ErrorKind::kUsage, "OBJ holds a mesh, and the run has none", path, "-f", "make it first: aligngs mesh RUN"});
  const Mat3d rotation = options.offset ? Mat3d::identity() : rotation_to_y_up(room.up);
  const Vec3d offset = options.offset.value_or(Vec3d{});
  const ExportMesh all = export_mesh(room, options.mesh, pool);
  ExportReport report{.files = {path}};
  report.describe(all);
  std::string text = std::string("# aligngs ") + version() +
                     (options.offset ? ", axes of the files that were imported" : ", y up") + "; vertices: x y z" +
                     (all.texture.empty() ? " r g b\n" : "\n");
  if (!all.texture.empty()) {
    write_material(path, all.texture, report);
    text += "mtllib " + report.files[1].filename().string() + "\nusemtl photos\n";
  }
  AtomicFile file(path);
  size_t base = 1;  // OBJ counts from 1, through all objects
  const auto underscored = [](std::string name) {
    for (char& c : name) c = c == ' ' || c == '\t' ? '_' : c;
    return name;
  };
  for (const ObjectMesh& object : all.objects) {
    const TriangleMesh& mesh = object.mesh;
    text += "o " + underscored(object.name) + "\ng " +
            underscored(object.class_name.empty() ? object.name : object.class_name) + "\n";
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
      const Vec3d p = rotation * mesh.vertices[v].cast<double>() + offset;
      const int digits = norm(offset) > 0 ? 12 : 6;
      text += fmt::format("v {:.{}g} {:.{}g} {:.{}g}", p.x, digits, p.y, digits, p.z, digits);
      if (!mesh.colors.empty() && object.uv.empty())
        text += fmt::format(" {:.4f} {:.4f} {:.4f}", mesh.colors[v][0] / 255., mesh.colors[v][1] / 255.,
                            mesh.colors[v][2] / 255.);
      text += '\n';
    }
    for (const Vec3f& normal : mesh.normals) {
      const Vec3d n = rotation * normal.cast<double>();
      text += fmt::format("vn {:.4f} {:.4f} {:.4f}\n", n.x, n.y, n.z);
    }
    for (const auto& place : object.uv) text += fmt::format("vt {:.6f} {:.6f}\n", place[0], 1 - place[1]);
    const std::string corner = object.uv.empty() ? (mesh.normals.empty() ? "{0}" : "{0}//{0}")
                                                 : (mesh.normals.empty() ? "{0}/{0}" : "{0}/{0}/{0}");
    for (const auto& t : mesh.triangles) {
      text += 'f';
      for (const uint32_t v : t) text += ' ' + fmt::format(fmt::runtime(corner), base + v);
      text += '\n';
    }
    base += mesh.vertices.size();
    file.write(text);
    text.clear();
  }
  file.commit();
  return report;
}

}  // namespace aligngs
