#include "edit/removal_score.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "scene/mesh_ply.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr int kSize = 32;  // pixels a side

/// A square floor of 2 m at z = 0.
TriangleMesh floor_mesh() {
  TriangleMesh mesh;
  mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.colors.assign(4, {128, 128, 128});
  mesh.labels.assign(4, 3);
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// A camera 2 m above the floor that looks down.
Camera camera_above() {
  Camera camera;
  camera.width = camera.height = kSize;
  camera.fx = camera.fy = kSize;
  camera.cx = camera.cy = kSize / 2.0;
  camera.world_to_camera = Rigidd{Mat3d{{1, 0, 0, 0, -1, 0, 0, 0, -1}}, Vec3d{0, 0, 2}};
  return camera;
}

class RemovalScoreTest : public testing::Test {
 protected:
  RemovalScoreTest() : folder_(fs::path(testing::TempDir()) / "removal_score") {
    fs::remove_all(folder_);
    Image<uint8_t> mask(kSize, kSize, 1, 0);
    for (int y = 8; y < 24; ++y) {
      for (int x = 8; x < 24; ++x) *mask.pixel(x, y) = 255;
    }
    write_png(folder_ / "truth" / "mask" / "a.png", mask);
    write_png(folder_ / "truth" / "rgb" / "a.png", picture(120));
    write_mesh_ply(folder_ / "truth" / "mesh.ply", floor_mesh());
    write_file_atomically(
        folder_ / "truth" / "removal.json",
        R"({"schema": 1, "objects": [{"object": "box#1", "low": [-0.3, -0.3, 0], "high": [0.3, 0.3, 0.4]}]})");
  }
  static Image<uint8_t> picture(uint8_t inside) {
    Image<uint8_t> image(kSize, kSize, 3, 40);
    for (int y = 8; y < 24; ++y) {
      for (int x = 8; x < 24; ++x) std::fill_n(image.pixel(x, y), 3, inside);
    }
    return image;
  }
  RemovalScore score(uint8_t inside, const TriangleMesh& mesh) {
    write_png(folder_ / "renders" / "a.png", picture(inside));
    return score_removal(folder_ / "renders", folder_ / "truth", mesh, {camera_above()}, pool_);
  }
  ThreadPool pool_{2};
  fs::path folder_;
};

TEST_F(RemovalScoreTest, TheTrueRoomIsPerfect) {
  const RemovalScore s = score(120, floor_mesh());
  EXPECT_GT(s.psnr, 60);
  EXPECT_NEAR(s.ssim, 1, 1e-6);
  EXPECT_NEAR(s.fscore, 1, 1e-6);
}

TEST_F(RemovalScoreTest, AnErrorInsideOfTheMaskCounts) {
  EXPECT_NEAR(score(145, floor_mesh()).psnr, 20, 1) << "a tenth of the range is 20 dB";
}

TEST_F(RemovalScoreTest, AHoleInTheMeshIsMissed) {
  TriangleMesh hole = floor_mesh();
  hole.triangles.clear();
  EXPECT_EQ(score(120, hole).recall, 0);
}

TEST_F(RemovalScoreTest, WhatIsLeftOfTheObjectIsWrong) {
  TriangleMesh mesh = floor_mesh();
  for (const Vec3f& v : {Vec3f{-0.3f, -0.3f, 0.3f}, Vec3f{0.3f, -0.3f, 0.3f}, Vec3f{0.3f, 0.3f, 0.3f}}) {
    mesh.vertices.push_back(v);
    mesh.normals.push_back({0, 0, 1});
    mesh.colors.push_back({0, 0, 0});
    mesh.labels.push_back(41);
  }
  mesh.triangles.push_back({4, 5, 6});
  const RemovalScore s = score(120, mesh);
  EXPECT_LT(s.precision, 0.9);
  EXPECT_GT(s.recall, 0.99);
}

TEST_F(RemovalScoreTest, ASceneWithoutThatTruthIsRefused) {
  fs::remove(folder_ / "truth" / "removal.json");
  EXPECT_THROW(score(120, floor_mesh()), Error);
}

}  // namespace
}  // namespace aligngs
