// Exports opened by readers that are not ours: the Khronos validator, PlayCanvas' splat-transform, tinyusdz, assimp.
// `npm ci` in tests/node installs the first three, the Debian package assimp-utils the third; tests skip without them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include <cmath>

#include "core/testing/shell.h"
#include "edit/export/scene_export.h"
#include "edit/export/testing/painted_photos.h"
#include "edit/export/upright.h"
#include "edit/testing/small_room.h"
#include "gaussians/point_tree.h"
#include "io/json_text.h"
#include "support/process.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::output_of;
using testing_support::runs;

const fs::path kNodeFolder = fs::path(ALIGNGS_SOURCE_DIR) / "tests" / "node";

class ExportReaders : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "export_readers";
    fs::create_directories(folder_);
    room_ = small_room::make(pool_);
    // A first-degree harmonic, so that the parts of the formats that carry direction are read, too.
    room_.gaussians.model.sh_degree = 1;
    for (size_t i = 0; i < room_.gaussians.model.size(); ++i) {
      for (size_t k = 3; k < 12; ++k) room_.gaussians.model.sh[48 * i + k] = 0.05f * std::sin(static_cast<float>(k));
    }
  }
  std::string exported(const std::string& format) {
    const fs::path file = folder_ / ("room." + format);
    export_room(room_, format, file, pool_);
    return file.string();
  }
  /// The mesh alone, simplified, with a texture.
  std::string textured(const std::string& format) {
    const fs::path file = folder_ / ("textured." + format);
    ExportOptions options{.parts = RoomParts::kMesh};
    options.mesh.error = 0.001;
    options.mesh.photos = [this] { return painted::photos(room_.mesh, pool_); };
    export_room(room_, format, file, pool_, options);
    return file.string();
  }
  nlohmann::json read_by(const char* script, const std::string& file) {
    const std::string text = output_of("node '" + (kNodeFolder / script).string() + "' '" + file + "'");
    const nlohmann::json report = parse_json(text);
    EXPECT_FALSE(report.is_discarded()) << text;
    return report;
  }
  void needs_node(const char* package) {
    if (!runs("node --version") || !fs::exists(kNodeFolder / "node_modules" / package)) {
      GTEST_SKIP() << "needs node and `npm ci` in tests/node";
    }
  }
  /// A splat file read by splat-transform and written as PLY.
  GaussianModel converted(const std::string& format) {
    const fs::path ply = folder_ / ("from_" + format + ".ply");
    fs::remove(ply);
    const std::string command = "node '" +
                                (kNodeFolder / "node_modules/@playcanvas/splat-transform/bin/cli.mjs").string() +
                                "' -w '" + exported(format) + "' '" + ply.string() + "'";
    EXPECT_TRUE(runs(command)) << command;
    return fs::exists(ply) ? read_gaussian_ply(ply) : GaussianModel{};
  }
  /// The other reader's Gaussians are ours, whatever their order, within the precision of the format.
  void expect_same_room(const GaussianModel& read, const GaussianModel& ours, double position, double color,
                        double opacity) {
    ASSERT_EQ(read.size(), ours.size());
    const PointTree tree(positions_of(read));
    std::vector<PointTree::Neighbour> near;
    const std::vector<Vec3f> places = positions_of(ours);
    for (size_t i = 0; i < ours.size(); i += 7) {
      tree.nearest(places[i], 1, near);
      ASSERT_LT(near[0].distance, position) << "axes and scale";
      const size_t j = near[0].index;
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(base_color_of(read, j)[c], base_color_of(ours, i)[c], color);
      ASSERT_NEAR(opacity_of(read, j), opacity_of(ours, i), opacity);
      float a[3], b[3];
      for (size_t k = 0; k < 3; ++k) {
        a[k] = read.log_scales[3 * j + k];
        b[k] = ours.log_scales[3 * i + k];
      }
      for (size_t k = 0; k < 3; ++k) ASSERT_NEAR(a[k], b[k], 0.05);
      double aligned = 0;  // |q . q'|: the same orientation
      for (size_t k = 0; k < 4; ++k)
        aligned += static_cast<double>(read.rotations[4 * j + k]) * ours.rotations[4 * i + k];
      ASSERT_GT(std::abs(aligned), 0.995);
      for (size_t k = 3; k < 12; ++k) ASSERT_NEAR(read.sh[48 * j + k], ours.sh[48 * i + k], 0.05);
    }
  }
  ThreadPool pool_{2};
  EditableRoom room_;
  fs::path folder_;
};

TEST_F(ExportReaders, TheKhronosValidatorAcceptsTheGlb) {
  needs_node("gltf-validator");
  if (IsSkipped()) return;
  const std::string text =
      output_of("node '" + (kNodeFolder / "validate_glb.mjs").string() + "' '" + exported("glb") + "'");
  const nlohmann::json report = parse_json(text);
  ASSERT_FALSE(report.is_discarded()) << text;
  EXPECT_TRUE(report["errors"].empty()) << json_document(report["errors"]);
  EXPECT_TRUE(report["warnings"].empty()) << json_document(report["warnings"]);
  EXPECT_EQ(report["info"]["drawCallCount"], 5) << "four objects and the splats";
}

TEST_F(ExportReaders, TheKhronosValidatorAcceptsTextureAndCollisionMesh) {
  needs_node("gltf-validator");
  if (IsSkipped()) return;
  for (const std::string& file : {textured("glb"), exported("collision.glb")}) {
    const nlohmann::json report = read_by("validate_glb.mjs", file);
    EXPECT_TRUE(report["errors"].empty()) << json_document(report["errors"]);
    EXPECT_TRUE(report["warnings"].empty()) << json_document(report["warnings"]);
    EXPECT_EQ(report["info"]["drawCallCount"], 4) << "four objects";
  }
}

TEST_F(ExportReaders, TinyusdzReadsMeshesAndTextureOfTheUsdz) {
  needs_node("tinyusdz");
  if (IsSkipped()) return;
  const nlohmann::json report = read_by("read_usd.mjs", textured("usdz"));
  EXPECT_TRUE(report["loaded"].get<bool>()) << report["error"];
  ASSERT_EQ(report["meshes"].size(), 4u);
  for (const auto& mesh : report["meshes"]) {
    EXPECT_EQ(mesh["image"]["uri"], "texture.jpg");
    EXPECT_GT(mesh["image"]["bytes"], 1000);
  }
  const std::string layer = report["text"];
  for (const char* part :
       {"texCoord2f[] primvars:st", "semantics:labels:class = [\"pillow\"]", "rel material:binding = </room/photos>"}) {
    EXPECT_NE(layer.find(part), std::string::npos) << part;
  }
}

TEST_F(ExportReaders, AssimpReadsTheTextureOfTheObj) {
  if (!runs("assimp version")) GTEST_SKIP() << "needs the Debian package assimp-utils";
  const std::string text = output_of("assimp info '" + textured("obj") + "'");
  for (const char* name : {"floor.001", "pillow.002", "photos", "Texture Refs"}) EXPECT_THAT(text, HasSubstr(name));
}

TEST_F(ExportReaders, SplatTransformReadsTheSog) {
  needs_node("@playcanvas/splat-transform");
  if (IsSkipped()) return;
  expect_same_room(converted("sog"), room_.gaussians.model, 0.002, 0.01, 0.01);
}

TEST_F(ExportReaders, SplatTransformReadsTheSpz) {
  needs_node("@playcanvas/splat-transform");
  if (IsSkipped()) return;
  // SPZ files are right-up-back (their specification); splat-transform hands the numbers on as they are, while PLY is
  // right-down-front: half a turn about x.
  const Mat3d half_turn{{1, 0, 0, 0, -1, 0, 0, 0, -1}};
  expect_same_room(converted("spz"), rotated(room_.gaussians.model, half_turn), 0.002, 0.02, 0.01);
}

TEST_F(ExportReaders, SplatTransformReadsTheLabelledPly) {
  needs_node("@playcanvas/splat-transform");
  if (IsSkipped()) return;
  expect_same_room(converted("labels.ply"), room_.gaussians.model, 1e-5, 1e-4, 1e-4);
}

TEST_F(ExportReaders, TinyusdzReadsThePrimsOfTheUsd) {
  needs_node("tinyusdz");
  if (IsSkipped()) return;
  const std::string text =
      output_of("node '" + (kNodeFolder / "read_usd.mjs").string() + "' '" + exported("usda") + "'");
  const nlohmann::json report = parse_json(text);
  ASSERT_FALSE(report.is_discarded()) << text;
  EXPECT_TRUE(report["parsed"].get<bool>() && report["loaded"].get<bool>()) << report["error"];
  size_t points = 0;
  for (const auto& mesh : report["meshes"]) points += mesh["points"].get<size_t>();
  EXPECT_EQ(report["meshes"].size(), 8u) << "a surface and a collider per object";
  EXPECT_GE(points, room_.mesh.vertices.size());
  const std::string layer = report["text"];
  for (const char* part : {"metersPerUnit = 1", "upAxis = \"Y\"", "def Xform \"pillow_002\"",
                           "semantics:labels:class = [\"pillow\"]", "def ParticleField3DGaussianSplat \"splats\"",
                           "radiance:sphericalHarmonicsDegree = 1", "physics:approximation"}) {
    EXPECT_THAT(layer, HasSubstr(part));
  }
}

TEST_F(ExportReaders, AssimpReadsTheNodesOfTheGlb) {
  if (!runs("assimp version")) GTEST_SKIP() << "needs the Debian package assimp-utils";
  const std::string text = output_of("assimp info '" + exported("glb") + "'");
  for (const char* name : {"room", "floor.001", "box.001", "pillow.001", "pillow.002", "splats"})
    EXPECT_THAT(text, HasSubstr(name));
}

TEST_F(ExportReaders, AssimpReadsTheGroupsOfTheObj) {
  if (!runs("assimp version")) GTEST_SKIP() << "needs the Debian package assimp-utils";
  const std::string text = output_of("assimp info '" + exported("obj") + "'");
  for (const char* name : {"floor.001", "box.001", "pillow.001", "pillow.002"}) EXPECT_THAT(text, HasSubstr(name));
}

}  // namespace
}  // namespace aligngs
