#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/srgb.h"
#include "edit/export/glb_container.h"
#include "edit/export/object_meshes.h"
#include "edit/export/scene_export.h"
#include "edit/export/upright.h"
#include "gaussians/gaussian_geometry.h"
#include "io/image_file.h"

namespace aligngs {
namespace {

using Json = nlohmann::ordered_json;

/// Splats fainter than this are invisible and only cost space (alpha_min of the rasteriser).

uint16_t linear16(float srgb) { return static_cast<uint16_t>(std::lround(65535 * srgb_decode(srgb))); }

int add_object(GlbContainer& glb, const ObjectMesh& object, const Mat3d& rotation, int material) {
  const TriangleMesh& mesh = object.mesh;
  std::vector<float> positions, normals, feature(mesh.vertices.size(), static_cast<float>(object.instance));
  std::vector<uint16_t> colors;
  std::vector<uint32_t> indices;
  const auto push = [&](std::vector<float>& to, const Vec3f& v) {
    const Vec3d t = rotation * v.cast<double>();
    for (int a = 0; a < 3; ++a) to.push_back(static_cast<float>(t[a]));
  };
  for (const Vec3f& v : mesh.vertices) push(positions, v);
  for (const Vec3f& n : mesh.normals) push(normals, dot(n, n) > 0 ? normalized(n) : Vec3f{0, 0, 1});
  for (const auto& c : mesh.colors) {
    for (size_t k = 0; k < 3; ++k) colors.push_back(linear16(c[k] / 255.f));
    colors.push_back(65535);
  }
  std::vector<float> uv;
  for (const auto& place : object.uv) uv.insert(uv.end(), place.begin(), place.end());
  for (const auto& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  Json attributes = {{"POSITION", glb.add_floats(positions, 3, true)}};
  if (!normals.empty()) attributes["NORMAL"] = glb.add_floats(normals, 3);
  if (!uv.empty())
    attributes["TEXCOORD_0"] = glb.add_floats(uv, 2);
  else if (!colors.empty())
    attributes["COLOR_0"] = glb.add_colors16(colors);
  attributes["_FEATURE_ID_0"] = glb.add_floats(feature, 1);
  Json primitive = {{"attributes", attributes}, {"indices", glb.add_indices(indices)}, {"mode", 4}};
  if (material >= 0) primitive["material"] = material;
  const int id = glb.add("meshes", {{"name", object.name}, {"primitives", Json::array({primitive})}});
  Json node = {{"name", object.name}, {"mesh", id}};
  if (object.label >= 0)
    node["extras"] = {{"class", object.class_name}, {"class_id", object.label}, {"instance", object.instance}};
  return glb.add("nodes", node);
}

/// KHR_gaussian_splatting: rotation x y z w, linear scale, opacity, spherical harmonics per coefficient.
int add_splats(GlbContainer& glb, const EditableRoom& room, const Mat3d& rotation, size_t& written) {
  const GaussianModel model = rotated(room.gaussians.model, rotation);
  const std::vector<uint32_t> rows = visible_rows(model);
  written = rows.size();
  if (rows.empty()) return -1;
  std::vector<float> positions, rotations, scales, opacities, feature;
  std::vector<uint16_t> colors;  // linear, with opacity: for those who draw points
  for (const uint32_t i : rows) {
    const float* r = &model.rotations[4 * size_t(i)];
    const Quaternionf q = normalized(Quaternionf{r[0], r[1], r[2], r[3]});
    for (size_t a = 0; a < 3; ++a) {
      positions.push_back(model.positions[3 * size_t(i) + a]);
      scales.push_back(std::exp(model.log_scales[3 * size_t(i) + a]));
    }
    rotations.insert(rotations.end(), {q.x, q.y, q.z, q.w});
    opacities.push_back(opacity_of(model, i));
    const Vec3f color = base_color_of(model, i);
    for (int c = 0; c < 3; ++c) colors.push_back(linear16(std::clamp(color[c], 0.f, 1.f)));
    colors.push_back(static_cast<uint16_t>(std::lround(65535 * opacities.back())));
    feature.push_back(static_cast<float>(room.gaussians.labels.instance[i]));
  }
  Json attributes = {{"POSITION", glb.add_floats(positions, 3, true)},
                     {"COLOR_0", glb.add_colors16(colors)},
                     {"KHR_gaussian_splatting:ROTATION", glb.add_floats(rotations, 4)},
                     {"KHR_gaussian_splatting:SCALE", glb.add_floats(scales, 3)},
                     {"KHR_gaussian_splatting:OPACITY", glb.add_floats(opacities, 1)}};
  std::vector<float> coefficient;
  for (int degree = 0; degree <= model.sh_degree; ++degree) {
    for (int k = degree * degree; k < (degree + 1) * (degree + 1); ++k) {
      coefficient.clear();
      for (const uint32_t i : rows) {
        const float* sh = &model.sh[3 * (kShCoefficients * size_t(i) + static_cast<size_t>(k))];
        coefficient.insert(coefficient.end(), sh, sh + 3);
      }
      attributes["KHR_gaussian_splatting:SH_DEGREE_" + std::to_string(degree) + "_COEF_" +
                 std::to_string(k - degree * degree)] = glb.add_floats(coefficient, 3);
    }
  }
  attributes["_FEATURE_ID_0"] = glb.add_floats(feature, 1);
  const Json primitive = {{"attributes", attributes},
                          {"mode", 0},
                          {"extensions",
                           {{"KHR_gaussian_splatting",
                             {{"kernel", "ellipse"},
                              {"colorSpace", "srgb_rec709_display"},
                              {"sortingMethod", "cameraDistance"},
                              {"projection", "perspective"}}}}}};
  const int mesh = glb.add("meshes", {{"name", "splats"}, {"primitives", Json::array({primitive})}});
  glb.use_extension("KHR_gaussian_splatting");
  return glb.add("nodes", {{"name", "splats"}, {"mesh", mesh}});
}

/// The node "room" with a node per object. `material`: -1 for none.
Json add_objects(GlbContainer& glb, const ExportMesh& mesh, const Mat3d& rotation, int material) {
  Json children = Json::array();
  for (const ObjectMesh& object : mesh.objects) children.push_back(add_object(glb, object, rotation, material));
  return children;
}

/// Unlit: the photos' light is in the colours.
int add_material(GlbContainer& glb, const Image<uint8_t>& texture) {
  Json surface = {{"baseColorFactor", {1, 1, 1, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
  if (!texture.empty())
    surface["baseColorTexture"] = {{"index", glb.add_texture(encode_jpeg(texture, kTextureQuality), "image/jpeg")}};
  glb.use_extension("KHR_materials_unlit");
  // The material uses the vertex colours; without one Blender drops them.
  return glb.add("materials", {{"name", texture.empty() ? "vertex_color" : "photos"},
                               {"pbrMetallicRoughness", surface},
                               {"doubleSided", true},
                               {"extensions", {{"KHR_materials_unlit", Json::object()}}}});
}

/// The node above all others. glTF has y up: with an offset the positions keep their own axes, and the node turns them.
int add_root(GlbContainer& glb, const EditableRoom& room, const ExportOptions& options) {
  Json root = {{"name", "room"}};
  if (options.offset) {
    const std::array<double, 16> rows = root_matrix(rotation_to_y_up(room.up), *options.offset);
    Json columns = Json::array();
    for (size_t i = 0; i < 16; ++i) columns.push_back(rows[4 * (i % 4) + i / 4]);
    root["matrix"] = columns;
  }
  return glb.add("nodes", root);
}

Mat3d turn_of_positions(const EditableRoom& room, const ExportOptions& options) {
  return options.offset ? Mat3d::identity() : rotation_to_y_up(room.up);
}

void finish(GlbContainer& glb, int root, const Json& children, const std::filesystem::path& path) {
  if (!children.empty()) glb.json()["nodes"][static_cast<size_t>(root)]["children"] = children;
  glb.add("scenes", {{"name", "room"}, {"nodes", Json::array({root})}});
  glb.write(path);
}

}  // namespace

ExportReport write_glb(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                       const ExportOptions& options) {
  if (options.parts == RoomParts::kMesh && room.mesh.empty())
    throw Error({ErrorKind::kUsage, "a GLB of the mesh alone needs one, and the run has none", path, "--mesh-only",
                 "make it first: aligngs mesh RUN"});
  const Mat3d rotation = turn_of_positions(room, options);
  GlbContainer glb;
  ExportReport report{.files = {path}};
  const int root = add_root(glb, room, options);
  Json children = Json::array();
  const bool with_splats = options.parts != RoomParts::kMesh;
  const int splats = with_splats ? add_splats(glb, room, rotation, report.gaussians) : -1;
  if (with_splats) report.invisible = room.gaussians.model.size() - report.gaussians;
  if (options.parts != RoomParts::kSplats && !room.mesh.empty()) {
    const ExportMesh mesh = export_mesh(room, options.mesh, pool);
    report.describe(mesh);
    children = add_objects(glb, mesh, rotation, add_material(glb, mesh.texture));
  }
  if (splats >= 0) children.push_back(splats);
  finish(glb, root, children, path);
  return report;
}

ExportReport write_collision_glb(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                                 const ExportOptions& options) {
  if (room.mesh.empty())
    throw Error({ErrorKind::kUsage, "a collision mesh needs a mesh, and the run has none", path, "-f",
                 "make it first: aligngs mesh RUN"});
  const ExportMesh mesh = collision_mesh(room, options.mesh, pool);
  ExportReport report{.files = {path}};
  report.describe(mesh);
  GlbContainer glb;
  const int root = add_root(glb, room, options);
  finish(glb, root, add_objects(glb, mesh, turn_of_positions(room, options), -1), path);
  return report;
}

}  // namespace aligngs
