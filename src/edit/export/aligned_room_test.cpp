#include "edit/export/aligned_room.h"

#include <gtest/gtest.h>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

/// z up, one scene unit is 2 m, turned by 90 degrees about the vertical.
Similarity some_frame() { return {2, Mat3d{{0, 0, 1, 1, 0, 0, 0, 1, 0}}, {1, 2, 3}}; }

TEST(AlignedRoom, GaussiansAndMeshGoWhereTheFrameSays) {
  ThreadPool pool(2);
  const EditableRoom room = small_room::make(pool);
  const EditableRoom out = aligned(room, some_frame());
  const Similarity frame = export_frame(some_frame());
  for (const size_t i : {size_t(0), room.gaussians.model.size() - 1}) {
    const float *a = &room.gaussians.model.positions[3 * i], *b = &out.gaussians.model.positions[3 * i];
    const Vec3d expected = frame * Vec3d{a[0], a[1], a[2]};
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(b[k], expected[k], 1e-4);
  }
  ASSERT_FALSE(room.mesh.vertices.empty());
  const Vec3d expected = frame * room.mesh.vertices[0].cast<double>();
  EXPECT_NEAR(norm(out.mesh.vertices[0].cast<double>() - expected), 0, 1e-4);
}

TEST(AlignedRoom, SizesOfGaussiansAreScaled) {
  ThreadPool pool(2);
  const EditableRoom room = small_room::make(pool);
  const EditableRoom out = aligned(room, some_frame());
  EXPECT_NEAR(out.gaussians.model.log_scales[0] - room.gaussians.model.log_scales[0], std::log(2.0f), 1e-5);
}

TEST(AlignedRoom, UpOfTheRoomIsMinusY) {
  const Vec3d up_in_world = transpose_times(some_frame().rotation, Vec3d{0, 0, 1});
  const Vec3d up = export_frame(some_frame()).rotation * up_in_world;
  EXPECT_NEAR(norm(up - Vec3d{0, -1, 0}), 0, 1e-12);
}

}  // namespace
}  // namespace aligngs
