#include "mesh/unseen_surface.h"

#include <gmock/gmock.h>

namespace aligngs {
namespace {

constexpr double kTolerance = 0.03;

/// Looks along +z from the origin.
Camera forward_camera() {
  Camera camera;
  camera.width = camera.height = 100;
  camera.fx = camera.fy = 50;
  camera.cx = camera.cy = 50;
  return camera;
}

/// A square across the z axis, 2 * half wide.
void add_square_at(TriangleMesh& mesh, float z, float half) {
  const uint32_t first = static_cast<uint32_t>(mesh.vertices.size());
  for (const auto& [x, y] : {std::pair{-half, -half}, {half, -half}, {half, half}, {-half, half}})
    mesh.vertices.push_back({x, y, z});
  mesh.labels.resize(mesh.vertices.size(), static_cast<uint16_t>(first));
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

class UnseenSurface : public testing::Test {
 protected:
  size_t remove(const std::vector<Camera>& cameras) {
    ThreadPool pool(2);
    return remove_unseen_surface(mesh_, cameras, kTolerance, pool);
  }
  TriangleMesh mesh_;
};

TEST_F(UnseenSurface, WhatAnotherSurfaceHidesGoes) {
  add_square_at(mesh_, 1, 0.5f);
  add_square_at(mesh_, 1.2f, 0.3f);
  EXPECT_EQ(remove({forward_camera()}), 2u);
  EXPECT_THAT(mesh_.labels, testing::Each(0));
}

TEST_F(UnseenSurface, WhatASecondCameraSeesStays) {
  add_square_at(mesh_, 1, 0.5f);
  add_square_at(mesh_, 1.2f, 0.3f);
  Camera behind = forward_camera();
  behind.world_to_camera.rotation = {{-1, 0, 0, 0, 1, 0, 0, 0, -1}};
  behind.world_to_camera.translation = {0, 0, 3};
  EXPECT_EQ(remove({forward_camera(), behind}), 0u);
}

TEST_F(UnseenSurface, TheOtherSideOfAThinThingStays) {
  add_square_at(mesh_, 1, 0.5f);
  add_square_at(mesh_, 1.02f, 0.3f);
  EXPECT_EQ(remove({forward_camera()}), 0u);
}

TEST_F(UnseenSurface, WhatLiesOutsideOfAllImagesGoes) {
  add_square_at(mesh_, 1, 0.5f);
  add_square_at(mesh_, -1, 0.5f);
  EXPECT_EQ(remove({forward_camera()}), 2u);
}

TEST_F(UnseenSurface, WithoutCamerasNothingGoes) {
  add_square_at(mesh_, 1, 0.5f);
  EXPECT_EQ(remove({}), 0u);
}

}  // namespace
}  // namespace aligngs
