#include "room/structure_labels.h"

#include <gtest/gtest.h>

#include "room/testing/solid_room.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

using namespace solid_room;

constexpr auto kIsWall = static_cast<uint16_t>(StructureLabel::kWall),
               kIsFloor = static_cast<uint16_t>(StructureLabel::kFloor),
               kIsCeiling = static_cast<uint16_t>(StructureLabel::kCeiling),
               kIsOther = static_cast<uint16_t>(StructureLabel::kOther),
               kIsBeyond = static_cast<uint16_t>(StructureLabel::kBeyond);

/// 4 m x 3 m with a low chest; a hole in the wall x = 4 opens on a wall four metres behind.
Solids holed_room() {
  Solids solids = empty_room(4, 3);
  solids.erase(solids.begin() + 3);
  const double t = kThick;
  for (const SolidBox& more :
       {box(4, -t, 4 + t, 1, 0, kHigh), box(4, 2, 4 + t, 3 + t, 0, kHigh), box(4, 1, 4 + t, 2, 0, 1),
        box(4, 1, 4 + t, 2, 2, kHigh), box(8, -4, 8 + t, 8, -1, 5), box(1.2, 2, 2.8, 3, 0, 0.8)})
    solids.push_back(more);
  return solids;
}

/// The label that a level camera in the middle of the room has for what lies in a direction.
uint16_t label_towards(const Vec3d& place) {
  static const Solids solids = holed_room();
  static const RoomStructure structure = [] {
    ThreadPool pool(2);
    RoomStructureSettings settings;
    settings.across = 50;
    return find_structure(measured(look_around(solids, {{1.2, 1.3}, {2.6, 1.6}})), {0, -1, 0}, 1.0, settings, pool);
  }();
  const double turn = std::atan2(place.x - 2, place.z - 1.5),
               dip = std::asin((place.y + 1.5) /
                               std::sqrt((place.x - 2) * (place.x - 2) + (place.y + 1.5) * (place.y + 1.5) +
                                         (place.z - 1.5) * (place.z - 1.5)));
  const MeasuredView view = measured({look(solids, box_room::camera({2, -1.5, 1.5}, turn, dip))})[0];
  return structure_labels(view, structure).at(80, 60);
}

TEST(StructureLabels, WallsFloorAndCeilingHaveTheirOwn) {
  EXPECT_EQ(label_towards({0, -1.4, 1}), kIsWall);
  EXPECT_EQ(label_towards({2.2, 0, 0.8}), kIsFloor);
  EXPECT_EQ(label_towards({2.2, -kHigh, 0.8}), kIsCeiling);
}

TEST(StructureLabels, AChestIsSomethingElse) { EXPECT_EQ(label_towards({2, -0.4, 2}), kIsOther); }

TEST(StructureLabels, TheViewThroughAHoleIsBeyond) { EXPECT_EQ(label_towards({8, -1.5, 1.4}), kIsBeyond); }

TEST(StructureLabels, PixelsWithoutDepthHaveNone) {
  MeasuredView view = measured({look(holed_room(), box_room::camera({2, -1.5, 1.5}, 0))})[0];
  std::fill(view.depth.data.begin(), view.depth.data.end(), 0.0f);
  const Image<uint16_t> labels = structure_labels(view, {});
  EXPECT_EQ(labels.at(10, 10), kNoLabel);
}

TEST(StructureLabels, WithoutStructureAllIsSomethingElse) {
  const MeasuredView view = measured({look(holed_room(), box_room::camera({2, -1.5, 1.5}, 0))})[0];
  EXPECT_EQ(structure_labels(view, {}).at(80, 60), kIsOther);
}

}  // namespace
}  // namespace aligngs
