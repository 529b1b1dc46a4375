#include "scene/mesh_ply.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"

namespace aligngs {
namespace {

std::filesystem::path file_in_temp(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "mesh_ply_test";
  std::filesystem::create_directories(folder);
  return folder / name;
}

TriangleMesh small_mesh() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.colors = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {250, 251, 255}};
  mesh.labels = {0, 149, kNoLabel, 7};
  return mesh;
}

std::filesystem::path write_text(const std::string& name, const std::string& content) {
  const std::filesystem::path path = file_in_temp(name);
  std::ofstream(path) << content;
  return path;
}

const char kHeader[] =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";

TEST(MeshPly, WrittenMeshReadsBackEqual) {
  const TriangleMesh mesh = small_mesh();
  write_mesh_ply(file_in_temp("m.ply"), mesh);
  const TriangleMesh back = read_mesh_ply(file_in_temp("m.ply"));
  ASSERT_EQ(back.vertices.size(), 4u);
  EXPECT_FLOAT_EQ(back.vertices[3].z, 2);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.colors, mesh.colors);
  EXPECT_EQ(back.labels, mesh.labels);
  EXPECT_FLOAT_EQ(back.normals[2].z, 1);
}

TEST(MeshPly, AnEmptyMeshIsAValidFile) {
  write_mesh_ply(file_in_temp("empty.ply"), {});
  EXPECT_TRUE(read_mesh_ply(file_in_temp("empty.ply")).empty());
}

TEST(MeshPly, PolygonsAreFanned) {
  const TriangleMesh mesh = read_mesh_ply(write_text(
      "quad.ply", std::string(kHeader) + "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                         "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(MeshPly, AnIndexOutsideOfTheVerticesIsBadInput) {
  const auto path = write_text("index.ply", std::string(kHeader) +
                                                "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                                "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 4\n");
  EXPECT_THROW(read_mesh_ply(path), Error);
}

TEST(MeshPly, AVertexThatIsNotFiniteIsBadInput) {
  const auto path = write_text("nan.ply", std::string(kHeader) + "end_header\n0 0 0\n1 nan 0\n1 1 0\n0 1 0\n");
  EXPECT_THROW(read_mesh_ply(path), Error);
}

TEST(MeshPly, AVertexBeyondAllPlacesIsBadInput) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  EXPECT_THROW(read_mesh_ply(write_text("far.ply", header + "0 1e30 0\n")), Error);
  EXPECT_EQ(read_mesh_ply(write_text("map.ply", header + "5e5 6e6 0\n")).vertices.size(), 1u) << "a map's coordinates";
}

TEST(MeshPly, StripsOfTrianglesAreNamed) {
  const auto path = write_text("strips.ply",
                               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                               "float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                               "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  try {
    read_mesh_ply(path);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.details().field, "tristrips");
  }
}

TEST(MeshPly, CloudsKeepColoursAndDropZeroNormals) {
  const auto path = write_text("cloud.ply",
                               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                               "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                               "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
                               "1 2 3 0 0 0 255 0 51\n");
  const PointCloud cloud = read_cloud_file(path).cloud;
  ASSERT_EQ(cloud.size(), 1u);
  EXPECT_FALSE(cloud.has_normals());
  EXPECT_NEAR(cloud.colors[0].z, 0.2, 1e-6);
}

TEST(MeshPly, PointsWithoutAUsablePositionAreLeftOut) {
  const auto path = write_text("holes.ply",
                               "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
                               "property double z\nend_header\nnan 0 0\n1 2 3\n0 inf 0\n0 0 1e300\n");
  const CloudFile file = read_cloud_file(path);
  EXPECT_EQ(file.left_out, 3u);
  ASSERT_EQ(file.cloud.size(), 1u);
  EXPECT_EQ(file.positions.at(0).z, 3);
}

TEST(MeshPly, ColumnsOfDifferentLengthAreRefused) {
  TriangleMesh mesh = small_mesh();
  mesh.labels.pop_back();
  EXPECT_THROW(write_mesh_ply(file_in_temp("bad.ply"), mesh), Error);
}

}  // namespace
}  // namespace aligngs
