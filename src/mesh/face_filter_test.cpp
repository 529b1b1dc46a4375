#include "mesh/face_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/error.h"
#include "core/random.h"

namespace aligngs {
namespace {

constexpr int kSquares = 40;       // along a side
constexpr float kVoxel = 0.015f;   // metres: a voxel
constexpr double kNoise = 0.0015;  // metres: a tenth of a voxel

/// A surface over a square of 0.6 m, with normals.
TriangleMesh height_field(const std::function<double(double x, double y)>& height) {
  TriangleMesh mesh;
  for (int j = 0; j <= kSquares; ++j) {
    for (int i = 0; i <= kSquares; ++i) {
      const float x = kVoxel * float(i), y = kVoxel * float(j);
      mesh.vertices.push_back({x, y, static_cast<float>(height(double(x), double(y)))});
      mesh.normals.push_back({0, 0, 1});
    }
  }
  for (int j = 0; j < kSquares; ++j) {
    for (int i = 0; i < kSquares; ++i) {
      const auto a = static_cast<uint32_t>(j * (kSquares + 1) + i), b = a + 1, c = a + kSquares + 1, d = c + 1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({b, d, c});
    }
  }
  return mesh;
}

double level(double, double) { return 0; }

/// A step of 10 cm with a slope of 73 degrees, as marching cubes mesh it.
double ledge(double x, double) { return std::clamp((x - 0.3) / 0.03, 0.0, 1.0) * 0.1; }

TriangleMesh noisy_mesh(TriangleMesh mesh) {
  Random random(3);
  for (Vec3f& v : mesh.vertices) v.z += static_cast<float>(kNoise * random.normal());
  return mesh;
}

/// Root mean square of the distance along z to another mesh of as many vertices.
double error_along_z(const TriangleMesh& mesh, const TriangleMesh& truth) {
  double sum = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const double d = double(mesh.vertices[v].z) - double(truth.vertices[v].z);
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(mesh.vertices.size()));
}

/// Mean angle of the faces to z, degrees.
double mean_tilt(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3f a = mesh.vertices[t[0]];
    const Vec3f n = normalized(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
    sum += std::acos(std::min(1.0, std::abs(double(n.z)))) * 180 / std::acos(-1.0);
  }
  return sum / static_cast<double>(mesh.triangles.size());
}

FaceFilterOptions filter_of(int count) {
  FaceFilterOptions options;
  options.rounds = count;
  return options;
}

TEST(FaceFilter, TakesTheNoiseOfAWall) {
  ThreadPool pool(2);
  TriangleMesh mesh = noisy_mesh(height_field(level));
  const double tilt = mean_tilt(mesh);
  EXPECT_GT(tilt, 5);
  filter_faces(mesh, filter_of(5), pool);
  EXPECT_LT(mean_tilt(mesh), 0.4 * tilt);
  EXPECT_LT(error_along_z(mesh, height_field(level)), 0.7 * kNoise);
}

TEST(FaceFilter, KeepsAnEdge) {
  ThreadPool pool(2);
  const TriangleMesh truth = height_field(ledge);
  TriangleMesh mesh = truth;
  filter_faces(mesh, filter_of(5), pool);
  EXPECT_LT(error_along_z(mesh, truth), 0.05 * double(kVoxel)) << "of a step that is seven cells high";
}

TEST(FaceFilter, LeavesAPlaneAsItIs) {
  ThreadPool pool(2);
  const auto slope = [](double x, double y) { return 0.3 * x - 0.2 * y; };
  TriangleMesh mesh = height_field(slope);
  filter_faces(mesh, filter_of(10), pool);
  EXPECT_LT(error_along_z(mesh, height_field(slope)), 1e-6);
}

TEST(FaceFilter, NoRoundsChangeNothing) {
  ThreadPool pool(2);
  const TriangleMesh before = noisy_mesh(height_field(level));
  TriangleMesh mesh = before;
  filter_faces(mesh, filter_of(0), pool);
  EXPECT_EQ(error_along_z(mesh, before), 0);
}

TEST(FaceFilter, NoVertexMovesFartherThanTheLimit) {
  ThreadPool pool(2);
  const TriangleMesh before = noisy_mesh(height_field(level));
  TriangleMesh mesh = before;
  FaceFilterOptions options = filter_of(5);
  options.max_shift = 0.0005;
  filter_faces(mesh, options, pool);
  float most = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) most = std::max(most, norm(mesh.vertices[v] - before.vertices[v]));
  EXPECT_NEAR(most, 0.0005, 1e-6);
}

TEST(FaceFilter, TheNumberOfThreadsDoesNotMatter) {
  ThreadPool one(1), three(3);
  TriangleMesh a = noisy_mesh(height_field(ledge)), b = a;
  filter_faces(a, filter_of(5), one);
  filter_faces(b, filter_of(5), three);
  EXPECT_EQ(error_along_z(a, b), 0);
}

TEST(FaceFilter, VertexNormalsFollowTheFaces) {
  ThreadPool pool(2);
  const auto slope = [](double x, double) { return x; };
  TriangleMesh mesh = height_field(slope);
  filter_faces(mesh, filter_of(1), pool);
  for (const Vec3f& n : mesh.normals) EXPECT_NEAR(n.z, std::sqrt(0.5), 1e-5);
}

TEST(FaceFilter, FacesWithoutAreaMoveNothing) {
  ThreadPool pool(2);
  TriangleMesh mesh = height_field(level);
  mesh.triangles.push_back({5, 5, 6});
  mesh.triangles.push_back({0, 20, 40});  // in a line
  filter_faces(mesh, filter_of(5), pool);
  EXPECT_LT(error_along_z(mesh, height_field(level)), 1e-7);
}

TEST(FaceFilter, AMeshWithoutTrianglesStaysEmpty) {
  ThreadPool pool(2);
  TriangleMesh mesh;
  filter_faces(mesh, filter_of(5), pool);
  EXPECT_TRUE(mesh.empty());
}

TEST(FaceFilter, SettingsOutOfRangeAreRefused) {
  ThreadPool pool(1);
  TriangleMesh mesh = height_field(level);
  EXPECT_THROW(filter_faces(mesh, filter_of(-1), pool), Error);
  FaceFilterOptions options = filter_of(1);
  options.normal_sigma = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(filter_faces(mesh, options, pool), Error);
}

}  // namespace
}  // namespace aligngs
