#include "edit/touching_objects.h"

#include <gmock/gmock.h>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

constexpr int kTouchingChair = 19, kPillow = 57, kTouchingBook = 67;  // ADE20K classes

class TouchingObjects : public small_room::LabelledBoxes {
 protected:
  size_t split(int threads = 2) {
    ThreadPool pool(threads);
    return split_touching_objects(room_, ade20k_labels(), Vec3d{0, -1, 0}, pool);
  }
};

using testing::Each;

TEST_F(TouchingObjects, PillowsCornerToCornerAreTwo) {
  const auto large = add({0, -0.3f, 0}, {0.6f, 0, 0.6f}, kPillow);
  const auto small = add({0.64f, -0.3f, 0.64f}, {1.08f, 0, 1.08f}, kPillow);
  EXPECT_EQ(split(), 1u);
  EXPECT_THAT(numbers(large), Each(1));
  EXPECT_THAT(numbers(small), Each(2));
}

TEST_F(TouchingObjects, BooksOnThreeBoardsAreThree) {
  for (int board = 0; board < 3; ++board) {
    const float y = -0.36f * static_cast<float>(board);
    add({0, y - 0.28f, 0}, {0.8f, y, 0.2f}, kTouchingBook);
  }
  EXPECT_EQ(split(), 2u);
}

TEST_F(TouchingObjects, ALongBoxIsOne) {
  add({0, -0.2f, 0}, {2.0f, 0, 0.2f}, kTouchingBook);
  EXPECT_EQ(split(), 0u);
}

TEST_F(TouchingObjects, FurnitureIsNotCut) {
  add({0, -0.3f, 0}, {0.6f, 0, 0.6f}, kTouchingChair);
  add({0.64f, -0.3f, 0.64f}, {1.08f, 0, 1.08f}, kTouchingChair);
  EXPECT_EQ(split(), 0u);
}

TEST_F(TouchingObjects, ASmallLumpStays) {
  add({0, -0.4f, 0}, {0.8f, 0, 0.8f}, kPillow);
  add({0.84f, -0.12f, 0.84f}, {1.0f, 0, 1.0f}, kPillow);  // less than 15 % of the Gaussians
  EXPECT_EQ(split(), 0u);
}

TEST_F(TouchingObjects, NewNumbersFollowThoseOfTheClass) {
  add({0, -0.3f, 0}, {0.6f, 0, 0.6f}, kPillow);
  const auto small = add({0.64f, -0.3f, 0.64f}, {1.08f, 0, 1.08f}, kPillow);
  const auto other = add({3, -0.3f, 0}, {3.4f, 0, 0.4f}, kPillow, 7);
  split();
  EXPECT_THAT(numbers(small), Each(8));
  EXPECT_THAT(numbers(other), Each(7));
}

TEST_F(TouchingObjects, FaintGaussiansGoWithTheirSide) {
  add({0, -0.3f, 0}, {0.6f, 0, 0.6f}, kPillow);
  const auto small = add({0.64f, -0.3f, 0.64f}, {1.08f, 0, 1.08f}, kPillow);
  room_.model.opacity_logits[small.second - 1] = -5;
  split();
  EXPECT_THAT(numbers(small), Each(2));
}

TEST_F(TouchingObjects, TheSameOnAnyNumberOfThreads) {
  for (int k = 0; k < 4; ++k) {
    const float x = 0.4f * static_cast<float>(k), z = k % 2 ? 0.35f : 0;
    add({x, -0.3f, z}, {x + 0.44f, 0, z + 0.4f}, kPillow);
  }
  const std::vector<uint16_t> before = room_.labels.instance;
  split(1);
  const std::vector<uint16_t> one = room_.labels.instance;
  room_.labels.instance = before;
  split(3);
  EXPECT_EQ(room_.labels.instance, one);
}

}  // namespace
}  // namespace aligngs
