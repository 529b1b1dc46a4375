#include "edit/move_objects.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/mesh_selection.h"
#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

/// The small room, looked at along +z: +x is to the right, -y is up.
class MoveObjects : public testing::Test {
 protected:
  MoveObjects() : room_(small_room::make(pool_)) {
    Camera camera;
    camera.width = camera.height = 64;
    camera.fx = camera.fy = 64;
    camera.cx = camera.cy = 32;
    camera.world_to_camera.translation = {0, 1, 4};  // at (0, -1, -4)
    room_.cameras = {camera};
    for (const uint16_t l : room_.gaussians.labels.label) box_.push_back(l == small_room::kBox);
  }
  Vec3d moved_point(const Vec3d& p, const ObjectMotion& motion) { return motion_in_world(room_, box_, motion) * p; }
  static void expect_near(const Vec3d& a, const Vec3d& b) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], 0.03) << axis;
  }
  ThreadPool pool_{2};
  EditableRoom room_;
  std::vector<uint8_t> box_;
};

TEST_F(MoveObjects, RightUpAndTowardsTheViewer) {
  expect_near(moved_point({0, 0, 0.4}, {{0.5, 0, 0}, 0}), {0.5, 0, 0.4});
  expect_near(moved_point({0, 0, 0.4}, {{0, 0.2, 0}, 0}), {0, -0.2, 0.4});
  expect_near(moved_point({0, 0, 0.4}, {{0, 0, 0.3}, 0}), {0, 0, 0.1});
}

TEST_F(MoveObjects, ATurnIsAboutTheMiddleOfTheObject) {
  // Counter-clockwise from above, with x to the right and the viewer below: right goes away from the viewer.
  expect_near(moved_point({0.2, 0, 0.4}, {{}, 90}), {0, 0, 0.6});
  expect_near(moved_point({0, -0.2, 0.4}, {{}, 90}), {0, -0.2, 0.4});
}

TEST_F(MoveObjects, WithoutUpNothingMoves) {
  room_.up.reset();
  EXPECT_THROW(motion_in_world(room_, box_, {{0.5, 0, 0}, 0}), Error);
}

TEST_F(MoveObjects, NeighboursThatComeAlongAreOfTheObject) {
  std::vector<uint8_t> selected = box_;
  size_t floor = 0;
  while (room_.gaussians.labels.label[floor] != small_room::kFloor) ++floor;
  selected[floor] = 1;
  EditableRoom piece = piece_of(room_, selected, std::vector<uint8_t>(room_.mesh.vertices.size(), 0));
  claim_neighbours(piece, room_);
  for (const uint16_t l : piece.gaussians.labels.label) EXPECT_EQ(l, small_room::kBox);
}

TEST_F(MoveObjects, PartsOfThingsAloneKeepTheirNames) {
  std::vector<uint8_t> selected(box_.size(), 0);
  for (size_t i = 0, left = 5; i < box_.size() && left > 0; ++i) {
    if (room_.gaussians.labels.label[i] != small_room::kFloor) continue;
    selected[i] = 1;
    --left;
  }
  EditableRoom piece = piece_of(room_, selected, std::vector<uint8_t>(room_.mesh.vertices.size(), 0));
  claim_neighbours(piece, room_);
  for (const uint16_t l : piece.gaussians.labels.label) EXPECT_EQ(l, small_room::kFloor);
}

TEST_F(MoveObjects, ACopyHasANumberOfItsOwn) {
  std::vector<uint8_t> pillows;
  for (const uint16_t l : room_.gaussians.labels.label) pillows.push_back(l == small_room::kPillow);
  EditableRoom copy = piece_of(
      room_, pillows, select_vertices(room_.mesh, room_.gaussians.model, pillows, room_.gaussians.extent, pool_));
  const size_t before = room_.gaussians.model.size(), vertices = room_.mesh.vertices.size();
  number_anew(copy, room_);
  add_piece(room_, copy);
  EXPECT_EQ(room_.gaussians.model.size(), before + copy.gaussians.model.size());
  EXPECT_EQ(room_.mesh.vertices.size(), vertices + copy.mesh.vertices.size());
  std::vector<int> numbers;
  for (const Instance& o : list_instances(room_.gaussians.model, room_.gaussians.labels)) {
    if (o.label == small_room::kPillow) numbers.push_back(o.number);
  }
  EXPECT_THAT(numbers, testing::ElementsAre(1, 2, 3, 4));
}

}  // namespace
}  // namespace aligngs
