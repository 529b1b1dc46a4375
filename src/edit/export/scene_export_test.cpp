#include "edit/export/scene_export.h"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "core/error.h"
#include "core/random.h"
#include "core/srgb.h"
#include "edit/export/codebook.h"
#include "edit/export/glb_container.h"
#include "edit/export/object_meshes.h"
#include "edit/export/testing/painted_photos.h"
#include "edit/export/upright.h"
#include "edit/testing/small_room.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/gzip.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "io/zip_archive.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class SceneExport : public testing::Test {
 protected:
  SceneExport() : room_(small_room::make(pool_)), folder_(fs::path(testing::TempDir()) / "scene_export") {}
  fs::path file(const std::string& name) const { return folder_ / name; }
  ThreadPool pool_{2};
  EditableRoom room_;
  fs::path folder_;
};

nlohmann::json json_of_glb(const fs::path& path) {
  const std::string bytes = read_file(path);
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(load_number<uint32_t>(bytes.data() + 8, false), bytes.size());
  return parse_json(bytes.substr(20, load_number<uint32_t>(bytes.data() + 12, false)));
}

TEST_F(SceneExport, GlbHasANodePerObjectAndTheSplats) {
  const ExportReport report = export_room(room_, "glb", file("scene.glb"), pool_);
  EXPECT_EQ(report.objects, 4u);
  const nlohmann::json glb = json_of_glb(file("scene.glb"));
  std::vector<std::string> names;
  for (const auto& node : glb["nodes"]) names.push_back(node["name"]);
  EXPECT_THAT(names,
              testing::UnorderedElementsAre("room", "floor.001", "box.001", "pillow.001", "pillow.002", "splats"));
  for (const auto& node : glb["nodes"]) {
    if (node["name"] != "pillow.002") continue;
    EXPECT_EQ(node["extras"]["class"], "pillow");
    EXPECT_EQ(node["extras"]["class_id"], small_room::kPillow);
    EXPECT_EQ(node["extras"]["instance"], 2);
    const auto& attributes = glb["meshes"][node["mesh"].get<size_t>()]["primitives"][0]["attributes"];
    // The pillow lies 0 to 12 cm above the floor; glTF is y up.
    const auto& positions = glb["accessors"][attributes["POSITION"].get<size_t>()];
    EXPECT_NEAR(positions["min"][1].get<double>(), 0, 1e-3);
    EXPECT_NEAR(positions["max"][1].get<double>(), 0.12, 1e-3);
    EXPECT_NEAR(positions["min"][0].get<double>(), 0.4, 1e-3) << "x stays";
  }
  EXPECT_EQ(glb["extensionsUsed"], (nlohmann::json{"KHR_gaussian_splatting", "KHR_materials_unlit"}));
  EXPECT_TRUE(glb["materials"][0]["extensions"].contains("KHR_materials_unlit"));
}

TEST_F(SceneExport, GlbOfTheMeshOrTheSplatsAlone) {
  const ExportReport mesh = write_glb(file("mesh.glb"), room_, pool_, {.parts = RoomParts::kMesh});
  EXPECT_EQ(mesh.objects, 4u);
  EXPECT_EQ(mesh.gaussians, 0u);
  EXPECT_EQ(json_of_glb(file("mesh.glb"))["extensionsUsed"], nlohmann::json{"KHR_materials_unlit"});
  const ExportReport splats = write_glb(file("splats.glb"), room_, pool_, {.parts = RoomParts::kSplats});
  EXPECT_EQ(splats.objects, 0u);
  EXPECT_EQ(splats.gaussians, room_.gaussians.model.size());
  const nlohmann::json glb = json_of_glb(file("splats.glb"));
  EXPECT_EQ(glb["extensionsUsed"], nlohmann::json{"KHR_gaussian_splatting"});
  EXPECT_EQ(glb["meshes"].size(), 1u);
  room_.mesh = {};
  EXPECT_THROW(write_glb(file("none.glb"), room_, pool_, {.parts = RoomParts::kMesh}), Error);
  EXPECT_FALSE(fs::exists(file("none.glb")));
}

TEST_F(SceneExport, AnOffsetIsAddedInDoublePrecision) {
  ExportOptions options;
  options.offset = Vec3d{4e5, 5.6e6, 120.25};
  const Vec3d vertex = room_.mesh.vertices[0].cast<double>(), up = rotation_to_y_up(room_.up) * *options.offset;
  write_glb(file("far.glb"), room_, pool_, options);
  const nlohmann::json glb = json_of_glb(file("far.glb"));
  const nlohmann::json& matrix = glb["nodes"][0]["matrix"];
  for (size_t a = 0; a < 3; ++a) EXPECT_EQ(matrix[12 + a].get<double>(), up[static_cast<int>(a)]) << "y up";
  EXPECT_EQ(matrix[15], 1);
  write_usda(file("far.usda"), room_, pool_, options);
  EXPECT_THAT(read_file(file("far.usda")), HasSubstr("uniform token[] xformOpOrder = [\"xformOp:transform\"]"));
  write_obj(file("far.obj"), room_, pool_, options);
  const std::string obj = read_file(file("far.obj"));
  EXPECT_THAT(obj, HasSubstr("v 400000"));
  EXPECT_THAT(obj, Not(HasSubstr("y up")));
  double x = 0, y = 0, z = 0, nearest = 1;
  for (size_t at = obj.find("\nv "); at != std::string::npos; at = obj.find("\nv ", at + 1)) {
    ASSERT_EQ(std::sscanf(obj.c_str() + at, "\nv %lf %lf %lf", &x, &y, &z), 3);
    nearest = std::min(nearest, norm(Vec3d{x, y, z} - *options.offset - vertex));
  }
  EXPECT_LT(nearest, 1e-4) << "the vertex keeps its axes";
}

TEST_F(SceneExport, GlbSplatsHaveAColourForViewersThatDrawPoints) {
  write_glb(file("splats.glb"), room_, pool_, {.parts = RoomParts::kSplats});
  const nlohmann::json glb = json_of_glb(file("splats.glb"));
  const nlohmann::json& primitive = glb["meshes"][0]["primitives"][0];
  EXPECT_EQ(primitive["mode"], 0);
  const nlohmann::json& accessor = glb["accessors"][primitive["attributes"]["COLOR_0"].get<size_t>()];
  EXPECT_EQ(accessor["type"], "VEC4");
  EXPECT_EQ(accessor["normalized"], true);
  // The first Gaussian is one of a pillow: sRGB (0.2, 0.4, 0.8), opacity logistic(3); COLOR_0 is linear.
  const std::string bytes = read_file(file("splats.glb"));
  const size_t binary = 20 + load_number<uint32_t>(bytes.data() + 12, false) + 8;
  const size_t at = binary + glb["bufferViews"][accessor["bufferView"].get<size_t>()]["byteOffset"].get<size_t>();
  const double expected[] = {srgb_decode(0.2f), srgb_decode(0.4f), srgb_decode(0.8f), 1 / (1 + std::exp(-3.0))};
  for (size_t c = 0; c < 4; ++c)
    EXPECT_NEAR(load_number<uint16_t>(bytes.data() + at + 2 * c, false) / 65535.0, expected[c], 1e-3) << c;
}

TEST_F(SceneExport, GlbColoursAreLinear) {
  EXPECT_NEAR(srgb_decode(0.5f), 0.2140f, 1e-4);
  EXPECT_FLOAT_EQ(srgb_decode(0), 0);
  EXPECT_NEAR(srgb_decode(1), 1, 1e-6);
}

TEST_F(SceneExport, ObjHasOneGroupPerObject) {
  export_room(room_, "obj", file("scene.obj"), pool_);
  const std::string text = read_file(file("scene.obj"));
  for (const char* line :
       {"o floor.001\ng floor\n", "o box.001\ng box\n", "o pillow.001\ng pillow\n", "o pillow.002\ng pillow\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
}

TEST_F(SceneExport, TheCollisionMeshHasPlacesAndTrianglesAlone) {
  const ExportReport report = export_room(room_, "collision.glb", file("scene.collision.glb"), pool_);
  EXPECT_LT(report.triangles, report.triangles_before / 3);
  const nlohmann::json glb = json_of_glb(file("scene.collision.glb"));
  EXPECT_EQ(glb["meshes"].size(), 4u);
  for (const auto& mesh : glb["meshes"]) {
    EXPECT_EQ(mesh["primitives"][0]["attributes"].size(), 2u) << "POSITION, and the number of the object";
    EXPECT_FALSE(mesh["primitives"][0].contains("material"));
  }
}

TEST_F(SceneExport, ATexturedGlbHasOnePictureForAllObjects) {
  MeshOptions mesh{.error = 0.001, .photos = [&] { return painted::photos(room_.mesh, pool_); }};
  export_room(room_, "glb", file("textured.glb"), pool_, {.parts = RoomParts::kMesh, .mesh = mesh});
  const nlohmann::json glb = json_of_glb(file("textured.glb"));
  EXPECT_EQ(glb["images"].size(), 1u);
  EXPECT_EQ(glb["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
  for (const auto& m : glb["meshes"]) {
    EXPECT_TRUE(m["primitives"][0]["attributes"].contains("TEXCOORD_0"));
    EXPECT_FALSE(m["primitives"][0]["attributes"].contains("COLOR_0")) << "it would be multiplied with the texture";
  }
}

TEST_F(SceneExport, ATexturedObjNamesItsFiles) {
  MeshOptions mesh{.error = 0.001, .photos = [&] { return painted::photos(room_.mesh, pool_); }};
  const ExportReport report = export_room(room_, "obj", file("textured.obj"), pool_, {.mesh = mesh});
  ASSERT_EQ(report.files.size(), 3u);
  EXPECT_THAT(read_file(file("textured.obj")), HasSubstr("mtllib textured.mtl\nusemtl photos\n"));
  EXPECT_THAT(read_file(file("textured.mtl")), HasSubstr("map_Kd textured.jpg"));
  EXPECT_EQ(read_image_info(file("textured.jpg")).channels, 3);
}

TEST_F(SceneExport, UsdzIsStoredAndAligned) {
  MeshOptions mesh{.error = 0.001, .photos = [&] { return painted::photos(room_.mesh, pool_); }};
  export_room(room_, "usdz", file("room.usdz"), pool_, {.mesh = mesh});
  const std::string bytes = read_file(file("room.usdz"));
  const ZipArchive zip(file_source(file("room.usdz")));
  ASSERT_EQ(zip.entries().size(), 2u);
  EXPECT_EQ(zip.entries()[0].name, "room.usda") << "the stage is the first file";
  for (const ZipEntry& entry : zip.entries()) {
    EXPECT_EQ(entry.method, 0);
    const size_t extra = load_number<uint16_t>(bytes.data() + entry.header_offset + 28, false);
    EXPECT_EQ((entry.header_offset + 30 + entry.name.size() + extra) % 64, 0u) << entry.name;
  }
  const std::string stage = zip.read(zip.entries()[0]);
  EXPECT_THAT(stage, HasSubstr("asset inputs:file = @texture.jpg@"));
  EXPECT_THAT(stage, testing::Not(HasSubstr("ParticleField")));
}

TEST_F(SceneExport, EveryTriangleBelongsToOneObject) {
  size_t triangles = 0;
  for (const ObjectMesh& object : object_meshes(room_, pool_)) triangles += object.mesh.triangles.size();
  EXPECT_EQ(triangles, room_.mesh.triangles.size());
}

TEST_F(SceneExport, LabelledPlyCarriesObjects) {
  export_room(room_, "labels.ply", file("scene.labels.ply"), pool_);
  EXPECT_NE(read_file(file("scene.labels.ply")).find("property ushort instance"), std::string::npos);
  EXPECT_EQ(read_gaussian_ply(file("scene.labels.ply")).size(), room_.gaussians.model.size());
}

TEST_F(SceneExport, SogIsAZipWithAnImagePerAttribute) {
  export_room(room_, "sog", file("scene.sog"), pool_);
  const ZipArchive zip(file_source(file("scene.sog")));
  ASSERT_TRUE(zip.find("meta.json"));
  const nlohmann::json meta = parse_json(zip.read(*zip.find("meta.json")));
  EXPECT_EQ(meta["version"], 2);
  EXPECT_EQ(meta["count"], room_.gaussians.model.size());
  for (const char* name : {"means_l.webp", "means_u.webp", "scales.webp", "quats.webp", "sh0.webp"})
    EXPECT_TRUE(zip.find(name)) << name;
}

TEST_F(SceneExport, SpzAndSplatAreSmall) {
  export_room(room_, "splat", file("scene.splat"), pool_);
  EXPECT_EQ(fs::file_size(file("scene.splat")), 32 * room_.gaussians.model.size());
  export_room(room_, "spz", file("scene.spz"), pool_);
  EXPECT_LT(fs::file_size(file("scene.spz")), 20 * room_.gaussians.model.size());
  EXPECT_EQ(read_file(file("scene.spz")).substr(0, 2), "\x1f\x8b") << "gzip";
}

/// Harmonics of rooms are small: a standard deviation of 0.02 in the first degree, less in the others.
TEST_F(SceneExport, SpzTellsOfCoarseSteps) {
  GaussianModel model = room_.gaussians.model;
  EXPECT_EQ(coarse_spz_warning(model, 3), "");
  model.positions[0] = 1e6f;
  EXPECT_NE(coarse_spz_warning(model, 3).find("the farthest Gaussian is 1e+06 units"), std::string::npos);
  EXPECT_EQ(coarse_spz_warning(model, 1e6), "") << "fine for a room of that size";
}

TEST_F(SceneExport, SpzKeepsWhatDependsOnTheDirection) {
  GaussianModel& model = room_.gaussians.model;
  model.sh_degree = 3;
  Random random(1);
  for (size_t i = 0; i < model.size(); ++i) {
    for (size_t k = 3; k < 3 * kShCoefficients; ++k)
      model.sh[3 * kShCoefficients * i + k] = static_cast<float>((k < 12 ? 0.02 : 0.01) * random.normal());
  }
  export_room(room_, "spz", file("scene.spz"), pool_);
  const std::string body = gzip_expanded(read_file(file("scene.spz")), "scene.spz", uint64_t(1) << 30);
  const size_t n = model.size(), before = 16 + n * (9 + 1 + 3 + 3 + 4);
  ASSERT_EQ(body.size(), before + n * 45);
  const GaussianModel turned = rotated(model, Mat3d{{1, 0, 0, 0, -1, 0, 0, 0, -1}});
  for (const auto& [first, last, least] : {std::tuple{3u, 12u, 0.98}, std::tuple{12u, 48u, 0.95}}) {
    double xy = 0, xx = 0, yy = 0;
    for (size_t i = 0; i < n; ++i) {
      for (size_t k = first; k < last; ++k) {
        const double x = turned.sh[48 * i + k], y = (static_cast<uint8_t>(body[before + 45 * i + k - 3]) - 128) / 128.0;
        xy += x * y, xx += x * x, yy += y * y;
      }
    }
    EXPECT_GT(xy / std::sqrt(xx * yy), least) << "coefficients from " << first;
  }
}

TEST_F(SceneExport, TheSameRoomGivesTheSameBytes) {
  ThreadPool one(1);
  for (const std::string& format : export_formats()) {
    export_room(room_, format, file("a." + format), pool_);
    export_room(room_, format, file("b." + format), one);
    EXPECT_EQ(read_file(file("a." + format)), read_file(file("b." + format))) << format;
  }
}

TEST_F(SceneExport, WithoutLabelsEveryFormatButTheLabelsIsWritten) {
  GaussianModel model = room_.gaussians.model;
  model.semantic_channels = 0;
  model.semantics.clear();
  room_.gaussians = label_objects(model, room_.labels, small_room::kExtent, pool_);
  room_.mesh.labels.clear();
  for (const ExportFormat& row : export_format_rows()) {
    if (row.needs_labels) continue;
    const std::string format = row.name;
    const ExportReport report = export_room(room_, format, file("unlabelled." + format), pool_);
    EXPECT_GT(fs::file_size(report.files.front()), 100u) << format;
    EXPECT_EQ(report.objects, row.mesh ? 1u : 0u) << format;
  }
  EXPECT_THROW(export_room(room_, "labels.ply", file("unlabelled.labels.ply"), pool_), Error);
  EXPECT_FALSE(fs::exists(file("unlabelled.labels.ply")));
}

TEST_F(SceneExport, MistakesAreUsageErrors) {
  try {
    export_room(room_, "gltf", file("x"), pool_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    EXPECT_THAT(error.details().remedy, HasSubstr("glb"));
  }
  room_.mesh = {};
  EXPECT_THROW(export_room(room_, "obj", file("x.obj"), pool_), Error);
  EXPECT_FALSE(fs::exists(file("x.obj")));
  EXPECT_NO_THROW(export_room(room_, "glb", file("splats_only.glb"), pool_)) << "a GLB of splats alone is fine";
}

TEST(Upright, HarmonicsTurnWithTheRoom) {
  GaussianModel model;
  model.sh_degree = 3;
  model.resize(1);
  for (size_t k = 0; k < model.sh.size(); ++k) model.sh[k] = std::sin(3.f * static_cast<float>(k));
  model.rotations = {1, 0, 0, 0};
  const Mat3d rotation = rotation_matrix(normalized(Quaterniond{0.9, 0.2, -0.3, 0.4}));
  const GaussianModel turned = rotated(model, rotation);
  const auto value = [](const GaussianModel& m, const Vec3d& d) {
    double basis[kShCoefficients], sum = 0;
    sh_basis(3, d, basis);
    for (size_t k = 0; k < kShCoefficients; ++k) sum += basis[k] * m.sh[3 * k];
    return sum;
  };
  for (const Vec3d& d : {Vec3d{1, 0, 0}, Vec3d{0, 0.6, -0.8}, Vec3d{0.48, -0.6, 0.64}})
    EXPECT_NEAR(value(turned, rotation * d), value(model, d), 1e-4);
}

TEST(Upright, UpBecomesY) {
  for (const Vec3d& up : {Vec3d{0, -1, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{0.6, -0.8, 0}}) {
    const Mat3d r = rotation_to_y_up(up);
    EXPECT_NEAR((r * up).y, 1, 1e-9);
    EXPECT_NEAR(determinant(r), 1, 1e-9);
  }
}

TEST(Codebook, LevelsCoverTheValues) {
  std::vector<float> values;
  for (int i = 0; i < 5000; ++i) values.push_back(std::sin(static_cast<float>(i)));
  const std::vector<float> levels = scalar_codebook(values);
  ASSERT_EQ(levels.size(), 256u);
  for (const float v : values) EXPECT_NEAR(levels[nearest_level(levels, v)], v, 0.02);
  EXPECT_EQ(scalar_codebook({}).size(), 256u);
  EXPECT_EQ(nearest_level(scalar_codebook({2, 2, 2}), 2), 0);
}

}  // namespace
}  // namespace aligngs
