#include "cli/stages/surface_pictures.h"

#include "cli/pictures.h"
#include "io/image_file.h"
#include "metrics/visibility.h"

namespace aligngs {
namespace {

ImageF normals_of_hits(const TriangleMesh& mesh, const RayScene& rays, const Camera& camera, ThreadPool& pool) {
  const FirstHits hits = rays.cast(camera, pool);
  ImageF normals(camera.width, camera.height, 3);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const uint32_t t = hits.triangle.at(x, y);
      if (t == kNoTriangle) continue;
      const auto& corner = mesh.triangles[t];
      const Vec3d a = mesh.vertices[corner[0]].cast<double>();
      const Vec3d world =
          cross(mesh.vertices[corner[1]].cast<double>() - a, mesh.vertices[corner[2]].cast<double>() - a);
      Vec3d n = normalized(camera.world_to_camera.rotation * world);
      if (dot(n, camera.ray(x + 0.5, y + 0.5)) > 0) n = -n;
      for (int i = 0; i < 3; ++i) normals.at(x, y, i) = static_cast<float>(n[i]);
    }
  }
  return normals;
}

}  // namespace

ImageF face_normals(const TriangleMesh& mesh, const Camera& camera, ThreadPool& pool) {
  return normals_of_hits(mesh, RayScene(mesh), camera, pool);
}

void write_surface_pictures(const LoadedRun& run, const TriangleMesh& mesh, const std::vector<int>& views,
                            const std::filesystem::path& folder) {
  const RayScene rays(mesh);
  for (const int view : views) {
    const Camera camera = run.working_camera(view);
    write_png(folder / (run.scene().views[static_cast<size_t>(view)].name + ".png"),
              normal_picture(normals_of_hits(mesh, rays, camera, *run.pool)));
  }
}

}  // namespace aligngs
