#include "synth/raytracer.h"

#include <gtest/gtest.h>

#include "scene/look_at.h"
#include "scene/triangle_mesh.h"
#include "synth/mesh_builder.h"
#include "synth/shading.h"

namespace aligngs {
namespace {

/// A wall at y = 2 m (facing -y) with a small box in front of it.
RoomModel wall_and_box() {
  RoomModel room;
  room.width = room.depth = room.height = 3;
  MeshBuilder b(room, 1);
  b.begin("wall");
  b.use(Material{});
  b.rectangle({3, 2, -1}, {-6, 0, 0}, {0, 0, 4});
  b.begin("box");
  b.box({-0.2, 1.0, 0.3}, {0.2, 1.2, 0.7});
  return room;
}

Camera front_camera() {
  Camera c;
  c.width = 40;
  c.height = 30;
  c.fx = c.fy = 30;
  c.cx = 20;
  c.cy = 15;
  c.world_to_camera = look_at({0, 0, 0.5}, {0, 1, 0.5}, {0, 0, 1});
  return c;
}

TEST(RoomRays, DistanceIsThatOfTheTrianglesPlane) {
  const RoomModel room = wall_and_box();
  const RoomRays scene(room);
  const RayHit wall = scene.intersect({1, 0, 0.5}, {0.1, 1, 0.05});
  ASSERT_TRUE(wall.hit);
  EXPECT_NEAR(wall.distance, 2.0, 1e-9);
  EXPECT_FALSE(scene.intersect({1, 0, 0.5}, {0, -1, 0}).hit);
}

TEST(RoomRays, TheBoxHidesTheWall) {
  const RoomModel room = wall_and_box();
  const RoomRays scene(room);
  EXPECT_FALSE(scene.visible({0, 0, 0.5}, {0, 2, 0.5}));
  EXPECT_TRUE(scene.visible({0, 0, 0.5}, {1, 2, 0.5}));
}

TEST(RenderView, DepthLabelsAndNormalsAreExactAtPixelCentres) {
  const RoomModel room = wall_and_box();
  const RoomRays scene(room);
  ThreadPool pool(2);
  RayTraceOptions options;
  options.color = false;
  const RenderedView view = render_view(scene, nullptr, front_camera(), options, pool);
  EXPECT_TRUE(view.color.empty());
  EXPECT_NEAR(view.depth.at(20, 15), 1.0f, 1e-6);  // the box's front
  EXPECT_NEAR(view.depth.at(2, 2), 2.0f, 1e-6);    // the wall: z depth does not grow to the side
  EXPECT_EQ(view.instances.at(20, 15), 1);
  EXPECT_EQ(view.labels.at(2, 2), 0);
  EXPECT_NEAR(view.normal.at(2, 2, 1), -1.0f, 1e-6);
}

TEST(RenderView, PixelsWithoutSurfaceHaveNoDepthAndNoLabel) {
  const RoomModel room = wall_and_box();
  const RoomRays scene(room);
  ThreadPool pool(1);
  Camera away = front_camera();
  away.world_to_camera = look_at({0, 0, 0.5}, {0, -1, 0.5}, {0, 0, 1});
  RayTraceOptions options;
  options.color = false;
  const RenderedView view = render_view(scene, nullptr, away, options, pool);
  EXPECT_EQ(view.depth.at(5, 5), 0.0f);
  EXPECT_EQ(view.labels.at(5, 5), kNoLabel);
}

TEST(LookAt, PutsTheTargetInTheMiddleWithTheWorldUpright) {
  const Camera c = front_camera();
  const Vec3d q = c.world_to_camera * Vec3d{0, 5, 0.5};
  EXPECT_NEAR(q.x, 0, 1e-12);
  EXPECT_NEAR(q.y, 0, 1e-12);
  EXPECT_NEAR(q.z, 5, 1e-12);
  EXPECT_LT((c.world_to_camera * Vec3d{0, 5, 1.5}).y, 0);  // higher is up: y points down
  EXPECT_NEAR(determinant(c.world_to_camera.rotation), 1, 1e-12);
}

}  // namespace
}  // namespace aligngs
