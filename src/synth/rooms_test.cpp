#include "synth/rooms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"
#include "scene/label_set.h"

namespace aligngs {
namespace {

class Rooms : public testing::TestWithParam<const char*> {};

TEST_P(Rooms, AreClosedFurnishedAndFinelyTessellated) {
  const RoomModel room = build_room({GetParam(), 3, true});
  ASSERT_GT(room.triangles.size(), 100000u);
  ASSERT_EQ(room.triangles.size(), room.triangle_object.size());
  ASSERT_EQ(room.triangles.size(), room.triangle_material.size());
  double longest = 0;
  std::set<std::string> names;
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Vec3f a = room.positions[room.triangles[t][k]], b = room.positions[room.triangles[t][(k + 1) % 3]];
      longest = std::max(longest, static_cast<double>(norm(a - b)));
    }
    ASSERT_LT(room.triangle_object[t], room.objects.size());
    ASSERT_LT(room.triangle_material[t], room.materials.size());
  }
  EXPECT_LT(longest, 0.056);  // metrics on vertices need a dense surface
  for (const RoomObject& object : room.objects) {
    ASSERT_LT(object.label, ade20k_labels().size());
    EXPECT_EQ(ade20k_labels().find(object.class_name), object.label);
    names.insert(object.class_name);
  }
  EXPECT_GE(names.size(), 15u);
  for (const char* needed : {"wall", "floor", "ceiling", "windowpane", "door", "rug", "painting"}) {
    EXPECT_TRUE(names.count(needed)) << needed;
  }
}

TEST_P(Rooms, StayInsideTheirWalls) {
  const RoomModel room = build_room({GetParam(), 4, true});
  EXPECT_GE(room.width, 4.0);
  EXPECT_LE(room.width, 6.0);
  EXPECT_GE(room.depth, 3.5);
  EXPECT_LE(room.depth, 5.0);
  for (size_t v = 0; v < room.positions.size(); ++v) {
    const Vec3f& p = room.positions[v];
    ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    ASSERT_NEAR(norm(room.normals[v]), 1, 1e-3);
    ASSERT_GT(p.z, -0.01f);
    ASSERT_LT(p.z, room.height + 0.01);
    ASSERT_GT(p.x, -0.2f);  // windows lie in niches of 16 cm
    ASSERT_LT(p.x, room.width + 0.2);
    ASSERT_GT(p.y, -0.2f);
    ASSERT_LT(p.y, room.depth + 0.2);
  }
  for (const FurnitureFootprint& f : room.footprints) {
    EXPECT_GT(f.x0, -0.05);
    EXPECT_LT(f.x1, room.width + 0.05);
    EXPECT_GT(f.y0, -0.05);
    EXPECT_LT(f.y1, room.depth + 0.05);
  }
}

TEST_P(Rooms, LeaveThirtyPercentOfTheSurfaceBare) {
  for (const uint64_t seed : {1, 2}) EXPECT_GE(build_room({GetParam(), seed, true}).bare_area_share(), 0.30) << seed;
}

INSTANTIATE_TEST_SUITE_P(AllKinds, Rooms, testing::Values("bedroom", "living", "kitchen", "office"));

TEST(RoomSeeds, TheSameSeedGivesTheSameRoomAndAnotherSeedAnother) {
  const RoomModel a = build_room({"bedroom", 7, true}), b = build_room({"bedroom", 7, true}),
                  c = build_room({"bedroom", 8, true});
  ASSERT_EQ(a.positions.size(), b.positions.size());
  for (size_t i = 0; i < a.positions.size(); ++i) ASSERT_EQ(a.positions[i].x, b.positions[i].x);
  EXPECT_NE(a.width, c.width);
}

TEST(RoomSeeds, AnUnknownKindIsAUsageError) {
  try {
    build_room({"garage", 1, true});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kUsage);
  }
}

}  // namespace
}  // namespace aligngs
