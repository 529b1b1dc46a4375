#include <fmt/format.h>

#include "core/error.h"
#include "edit/export/object_meshes.h"
#include "edit/export/scene_export.h"
#include "edit/export/upright.h"
#include "io/atomic_file.h"

namespace aligngs {

ExportReport write_obj(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool) {
  if (room.mesh.empty())
    throw Error(
        {ErrorKind::kUsage, "OBJ holds a mesh, and the run has none", path, "-f", "make it first: aligngs mesh RUN"});
  const Mat3d rotation = rotation_to_y_up(room.up);
  ExportReport report;
  AtomicFile file(path);
  std::string text = std::string("# aligngs ") + ALIGNGS_VERSION + ", y up; vertices: x y z r g b\n";
  size_t base = 1;  // OBJ counts from 1, through all objects
  const auto underscored = [](std::string name) {
    for (char& c : name) c = c == ' ' || c == '\t' ? '_' : c;
    return name;
  };
  for (const ObjectMesh& object : object_meshes(room, pool)) {
    const TriangleMesh& mesh = object.mesh;
    text += "o " + underscored(object.name) + "\ng " +
            underscored(object.class_name.empty() ? object.name : object.class_name) + "\n";
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
      const Vec3d p = rotation * mesh.vertices[v].cast<double>();
      text += fmt::format("v {:.6g} {:.6g} {:.6g}", p.x, p.y, p.z);
      if (!mesh.colors.empty())
        text += fmt::format(" {:.4f} {:.4f} {:.4f}", mesh.colors[v][0] / 255., mesh.colors[v][1] / 255.,
                            mesh.colors[v][2] / 255.);
      text += '\n';
    }
    for (const Vec3f& normal : mesh.normals) {
      const Vec3d n = rotation * normal.cast<double>();
      text += fmt::format("vn {:.4f} {:.4f} {:.4f}\n", n.x, n.y, n.z);
    }
    for (const auto& t : mesh.triangles) {
      const size_t a = base + t[0], b = base + t[1], c = base + t[2];
      text += mesh.normals.empty() ? fmt::format("f {} {} {}\n", a, b, c)
                                   : fmt::format("f {0}//{0} {1}//{1} {2}//{2}\n", a, b, c);
    }
    base += mesh.vertices.size();
    file.write(text);
    text.clear();
    ++report.objects;
  }
  file.commit();
  report.files.push_back(path);
  return report;
}

}  // namespace aligngs
