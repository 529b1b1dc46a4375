#include "synth/simulated_priors.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/mesh_ply.h"
#include "scene/scene_writer.h"
#include "scene/view_data.h"
#include "synth/raytracer.h"
#include "synth/shading.h"
#include "synth/synth_purpose.h"
#include "synth/teacher_cloud.h"

namespace aligngs {
namespace {

/// A captured surface where the teacher expects a room: one object of one material.
RoomModel room_of(const TriangleMesh& mesh) {
  RoomModel room;
  room.name = "capture";
  room.positions = mesh.vertices;
  room.triangles = mesh.triangles;
  room.normals.resize(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    const Vec3f n = cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    for (const uint32_t v : t) room.normals[v] += n;
  }
  for (Vec3f& n : room.normals) n = normalized(n);
  room.uvs.resize(mesh.vertices.size());
  room.triangle_object.assign(mesh.triangles.size(), 0);
  room.triangle_material.assign(mesh.triangles.size(), 0);
  room.objects.emplace_back();
  room.materials.emplace_back();
  return room;
}

struct Box {
  Vec3d low, high;
};

Box box_of(const TriangleMesh& mesh) {
  Box box{mesh.vertices.front().cast<double>(), mesh.vertices.front().cast<double>()};
  for (const Vec3f& v : mesh.vertices) {
    for (int k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], static_cast<double>(v[k]));
      box.high[k] = std::max(box.high[k], static_cast<double>(v[k]));
    }
  }
  return box;
}

/// The scene's own, else what is up in the photos on average: people hold cameras level.
Vec3d up_of(const Scene& scene) {
  if (scene.up) return *scene.up;
  Vec3d up;
  for (const Camera& c : scene.evaluation_cameras) up -= c.world_to_camera.rotation.row(1);
  return normalized(up);
}

TriangleMesh truth_of(const Scene& scene) {
  if (scene.truth_mesh.empty()) {
    throw_bad_input(scene.folder / "truth" / "mesh.ply", "",
                    "the simulated network looks at the true surface, and there is none",
                    "use a scene with a reference mesh");
  }
  if (!scene.metric) {
    throw_bad_input(scene.folder / "scene.json", "units",
                    "errors are simulated in metres, and this scene has another unit", "use a scene in metres");
  }
  TriangleMesh mesh = read_mesh_ply(scene.truth_mesh);
  if (mesh.triangles.empty())
    throw_bad_input(scene.truth_mesh, "faces", "the true surface has none", "use a scene with a reference mesh");
  return mesh;
}

PriorsJson priors_of(const SimulatedPriorOptions& options) {
  PriorsJson priors;
  priors.depth = PriorJson{fmt::format("simulated feed-forward ({})", teacher_level_name(options.level)), "", {}};
  priors.depth_scale = DepthScale::kScene;
  priors.depth->settings["poses"] = priors.depth->model;
  priors.depth->settings["seed"] = std::to_string(options.seed);
  return priors;
}

}  // namespace

void write_simulated_priors(const Scene& scene, const std::filesystem::path& folder,
                            const SimulatedPriorOptions& options, ThreadPool& pool) {
  const std::vector<std::filesystem::path> sources = {scene.folder};
  require_scene_place(folder, options.overwrite, sources);
  const TriangleMesh mesh = truth_of(scene);
  SceneWriter writer(folder, options.overwrite, sources);
  const RoomModel room = room_of(mesh);
  const RoomRays rays(room);
  std::vector<RenderedView> seen;
  for (const Camera& camera : scene.evaluation_cameras)
    seen.push_back(render_view(rays, nullptr, camera, {false, 1}, pool));
  const Box box = box_of(mesh);
  const Vec3d size = box.high - box.low;
  GeometryTeacher teacher =
      simulate_geometry_teacher(seen, geometry_teacher_settings(options.level), (box.low + box.high) * 0.5,
                                std::max({size.x, size.y, size.z}), up_of(scene), Random(options.seed), pool);
  SceneParts parts;
  parts.split.train.emplace();
  parts.split.test.emplace();
  for (const int i : scene.train) parts.split.train->push_back(scene.views[static_cast<size_t>(i)].name);
  for (const int i : scene.test) parts.split.test->push_back(scene.views[static_cast<size_t>(i)].name);
  for (size_t i = 0; i < scene.views.size(); ++i) {
    SceneViewParts view{};
    view.name = scene.views[i].name;
    view.camera = teacher.views[i].camera;
    view.image_file = scene.views[i].image;
    view.prior_depth = teacher.views[i].depth;
    view.prior_confidence = teacher.views[i].confidence;
    view.truth_depth = seen[i].depth;
    view.truth_camera = scene.evaluation_cameras[i];
    writer.add_view(view);
  }
  std::vector<Image<uint8_t>> photos;
  for (const int i : scene.train) photos.push_back(read_view_photo(scene.views[static_cast<size_t>(i)]));
  std::vector<TeacherCloudView> cloud_views;
  for (size_t k = 0; k < photos.size(); ++k)
    cloud_views.push_back({&teacher.views[static_cast<size_t>(scene.train[k])], &photos[k]});
  parts.cloud = teacher_cloud(cloud_views, stream_of(Random(options.seed), SynthPurpose::kPriorCloud));
  parts.description.metric = true;
  parts.description.up = scene.up;
  parts.description.source = fmt::format("{}; simulated priors ({})", scene.source, teacher_level_name(options.level));
  parts.priors = priors_of(options);
  parts.truth_mesh_file = scene.truth_mesh;
  writer.finish(parts);
}

}  // namespace aligngs
