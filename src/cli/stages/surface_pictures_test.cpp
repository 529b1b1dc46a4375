#include "cli/stages/surface_pictures.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

TEST(FaceNormals, AreThoseOfTheTrianglesTurnedToTheCamera) {
  TriangleMesh mesh;  // the left half faces the camera, the right half is turned away and seen from behind
  mesh.vertices = {{-1, -1, 2}, {0, -1, 2}, {0, 1, 2}, {-1, 1, 2}, {1, -1, 2}, {1, 1, 2}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {1, 4, 5}, {1, 5, 2}};
  Camera camera;
  camera.width = camera.height = 20;
  camera.fx = camera.fy = 10;
  camera.cx = camera.cy = 10;
  ThreadPool pool(1);
  const ImageF normals = face_normals(mesh, camera, pool);
  for (const int x : {7, 12}) {
    EXPECT_FLOAT_EQ(normals.at(x, 10, 2), -1) << x;
    EXPECT_FLOAT_EQ(normals.at(x, 10, 0), 0) << x;
  }
  for (int i = 0; i < 3; ++i) EXPECT_EQ(normals.at(0, 10, i), 0) << "beside the wall nothing is met";
}

}  // namespace
}  // namespace aligngs
