#include "edit/export/moved_room.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

Similarity similarity(double scale, const Vec3d& translation) { return {scale, Mat3d::identity(), translation}; }

TEST(MovedRoom, OriginalCoordinatesUndoTheMoveOfAnImport) {
  ThreadPool pool(2);
  const EditableRoom room = small_room::make(pool);
  const OffsetRoom moved = in_original_coordinates(room, similarity(0.001, {0.05, -0.2, 0.3}), "scene.json", false);
  EXPECT_EQ(norm(moved.offset), 0);
  const EditableRoom& out = moved.room;
  const float *a = room.gaussians.model.positions.data(), *b = out.gaussians.model.positions.data();
  EXPECT_NEAR(b[0], 0.001 * a[0] + 0.05, 1e-6);
  EXPECT_NEAR(b[1], 0.001 * a[1] - 0.2, 1e-6);
  EXPECT_NEAR(b[2], 0.001 * a[2] + 0.3, 1e-6);
  EXPECT_NEAR(out.gaussians.model.log_scales[0] - room.gaussians.model.log_scales[0], std::log(0.001), 1e-5);
  ASSERT_FALSE(room.mesh.vertices.empty());
  EXPECT_NEAR(out.mesh.vertices[0].y, 0.001 * room.mesh.vertices[0].y - 0.2, 1e-6);
}

TEST(MovedRoom, MapCoordinatesDoNotFitTheFiles) {
  ThreadPool pool(2);
  const EditableRoom room = small_room::make(pool);
  try {
    in_original_coordinates(room, similarity(1, {4e5, 5.6e6, 120}), "scene.json", false);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_THAT(error.what(), testing::HasSubstr("5.6e+06"));
  }
}

TEST(MovedRoom, MapCoordinatesAreAnOffsetWhereTheFormatHoldsOne) {
  ThreadPool pool(2);
  const EditableRoom room = small_room::make(pool);
  const OffsetRoom out = in_original_coordinates(room, similarity(2, {4e5, 5.6e6, 120}), "scene.json", true);
  EXPECT_EQ(out.offset.y, 5.6e6);
  EXPECT_FLOAT_EQ(out.room.mesh.vertices[0].y, 2 * room.mesh.vertices[0].y);
}

}  // namespace
}  // namespace aligngs
