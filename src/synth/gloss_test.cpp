#include "synth/gloss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/srgb.h"
#include "scene/label_set.h"
#include "scene/look_at.h"
#include "synth/mesh_builder.h"
#include "synth/rooms.h"
#include "synth/shading.h"

namespace aligngs {
namespace {

Material glowing(float radiance) {
  Material m;
  m.a = {1, 1, 1};
  m.emission = radiance;
  return m;
}

/// A camera at the origin looks at a mirror 2 m ahead (y = 2). Behind the camera, at y = -1, a wall glows.
RoomModel mirror_room(const Material& mirror, float behind) {
  RoomModel room;
  room.width = room.depth = room.height = 3;
  MeshBuilder b(room, 1);
  b.begin("mirror");
  b.use(mirror);
  b.rectangle({3, 2, -3}, {-6, 0, 0}, {0, 0, 6});
  b.begin("wall");
  b.use(glowing(behind));
  b.rectangle({-6, -1, -6}, {12, 0, 0}, {0, 0, 12});
  room.strong_gloss = true;
  return room;
}

Camera camera_towards(const Vec3d& target) {
  Camera c;
  c.width = c.height = 9;
  c.fx = c.fy = 30;
  c.cx = c.cy = 4.5;
  c.world_to_camera = look_at({0, 0, 0}, target, {0, 0, 1});
  return c;
}

RenderedView picture_of(const RoomModel& room, const Camera& camera) {
  ThreadPool pool(1);
  const RoomRays rays(room);
  LightCache lights;
  lights.irradiance.assign(room.positions.size(), {});
  return render_view(rays, &lights, camera, {true, 1}, pool);
}

/// Undoes film and coding: exposure 1.
double radiance_at(const RenderedView& view, int x, int y) {
  return -std::log(1 - static_cast<double>(srgb_decode(view.color.at(x, y, 1))));
}

Material polished(float own, float reflectance) {
  Material m = glowing(own);
  m.gloss = 1;
  m.reflectance = reflectance;
  m.roughness = 0;
  return m;
}

TEST(Gloss, APerfectMirrorShowsTheWallBehindTheCamera) {
  const RenderedView view = picture_of(mirror_room(polished(0.1f, 1), 0.7f), camera_towards({0, 1, 0}));
  EXPECT_NEAR(radiance_at(view, 4, 4), 0.7, 1e-3);
  EXPECT_FLOAT_EQ(view.mirrored.at(4, 4), 1);
}

TEST(Gloss, AtARightAngleTheReflectanceIsMirroredAndTheRestIsOwnLight) {
  const RenderedView view = picture_of(mirror_room(polished(0.2f, 0.04f), 1.0f), camera_towards({0, 1, 0}));
  EXPECT_NEAR(radiance_at(view, 4, 4), 0.96 * 0.2 + 0.04 * 1.0, 1e-3);
}

TEST(Gloss, TheMirroredShareFollowsSchlicksLaw) {
  const RenderedView view = picture_of(mirror_room(polished(0.2f, 0.04f), 1.0f), camera_towards({1, 1, 0}));
  const double share = 0.04 + 0.96 * std::pow(1 - std::sqrt(0.5), 5);
  EXPECT_NEAR(view.mirrored.at(4, 4), share, 1e-5);
  EXPECT_NEAR(radiance_at(view, 4, 4), (1 - share) * 0.2 + share, 1e-3);
}

TEST(Gloss, AReflectedRayLeavesAsItArrives) {
  // Seen at 45 degrees to the right, a mirror shows what lies as far to its right: a brighter part of the wall.
  RoomModel room = mirror_room(polished(0, 1), 0.2f);
  MeshBuilder b(room, 2);
  b.begin("wall");
  b.use(glowing(0.9f));
  b.rectangle({4.5, -0.9, -1}, {1, 0, 0}, {0, 0, 2});  // from (0, 0) to (2, 2), and on to (4.9, -0.9)
  const RenderedView view = picture_of(room, camera_towards({1, 1, 0}));
  EXPECT_NEAR(radiance_at(view, 4, 4), 0.9, 1e-3);
}

TEST(Gloss, ASensorMeasuresTheRoomInASilveredMirror) {
  const RenderedView view = picture_of(mirror_room(polished(0, 0.92f), 0.7f), camera_towards({0, 1, 0}));
  EXPECT_NEAR(view.depth.at(4, 4), 2, 1e-6);
  EXPECT_NEAR(view.sensed.at(4, 4), 2 + 3, 2e-3);
}

TEST(Gloss, ASensorMeasuresPolishItself) {
  const RenderedView view = picture_of(mirror_room(polished(0, 0.06f), 0.7f), camera_towards({0, 1, 0}));
  EXPECT_EQ(view.sensed.at(4, 4), view.depth.at(4, 4));
}

TEST(Gloss, APaneShowsTheViewOutsideAndReturnsNothing) {
  Material pane = polished(0.3f, 0.08f);
  pane.see_through = true;
  pane.kind = TextureKind::kOutside;
  const RenderedView view = picture_of(mirror_room(pane, 0), camera_towards({0, 1, 0}));
  EXPECT_NEAR(view.depth.at(4, 4), 2, 1e-6);
  EXPECT_EQ(view.sensed.at(4, 4), 0);
  EXPECT_GT(radiance_at(view, 4, 4), 0.005);
}

TEST(Gloss, RoughPolishBlursWhatItMirrors) {
  // Looking at the border between a bright and a dark half of the wall behind: many rays see both.
  const auto spread = [](float roughness) {
    Material m = polished(0, 1);
    m.roughness = roughness;
    m.mirror_rays = 64;
    RoomModel room = mirror_room(m, 0.0001f);
    MeshBuilder b(room, 2);
    b.begin("wall");
    b.use(glowing(1));
    b.rectangle({0.002, -0.9, -2}, {4, 0, 0}, {0, 0, 4});
    return radiance_at(picture_of(room, camera_towards({0, 1, 0})), 4, 4);
  };
  EXPECT_NEAR(spread(0), 0, 1e-3);
  EXPECT_NEAR(spread(0.05f), 0.5, 0.15);
}

class GlossyRooms : public testing::TestWithParam<const char*> {};

TEST_P(GlossyRooms, KeepTheirShapeAndLights) {
  const RoomModel dull = build_room({GetParam(), 3, true}), glossy = build_room({GetParam(), 3, true, true});
  ASSERT_EQ(dull.positions.size(), glossy.positions.size());
  for (size_t i = 0; i < dull.positions.size(); ++i) ASSERT_EQ(dull.positions[i].x, glossy.positions[i].x);
  EXPECT_EQ(dull.lights.size(), glossy.lights.size());
  EXPECT_FALSE(dull.strong_gloss);
  EXPECT_TRUE(glossy.strong_gloss);
}

TEST_P(GlossyRooms, HaveAPolishedFloorAMirrorAndWindowsToLookThrough) {
  const RoomModel room = build_room({GetParam(), 3, true, true});
  std::map<std::string, float> reflectance;
  size_t mirrors = 0, panes = 0;
  for (const RoomObject& object : room.objects) {
    mirrors += object.class_name == "mirror";
    EXPECT_EQ(ade20k_labels().find(object.class_name), object.label);
  }
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    const Material& m = room.materials[room.triangle_material[t]];
    float& most = reflectance[room.objects[room.triangle_object[t]].class_name];
    most = std::max(most, m.gloss * m.reflectance);
    panes += m.see_through;
  }
  EXPECT_EQ(mirrors, 1u);
  EXPECT_GT(panes, 0u);
  EXPECT_FLOAT_EQ(reflectance["floor"], 0.05f);
  EXPECT_FLOAT_EQ(reflectance["mirror"], 0.92f);
  EXPECT_FLOAT_EQ(reflectance["windowpane"], 0.08f);
  EXPECT_LT(reflectance["wall"], 0.05f);
}

INSTANTIATE_TEST_SUITE_P(All, GlossyRooms, testing::Values("bedroom", "living", "kitchen", "office"));

}  // namespace
}  // namespace aligngs
