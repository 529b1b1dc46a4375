#include "edit/relation/object_box.h"

#include <cmath>
#include <numeric>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

class ObjectBoxTest : public small_room::LabelledBoxes {
 protected:
  ObjectBox box() const {
    std::vector<uint32_t> rows(room_.model.size());
    std::iota(rows.begin(), rows.end(), 0);
    return object_box(room_.model, rows, BoxAxes({0, -1, 0}));
  }
};

TEST_F(ObjectBoxTest, HasTheSizeOfTheThing) {
  add({0, -0.8f, 1}, {1, 0, 1.6f}, small_room::kBox);
  EXPECT_NEAR(box().length, 1, 0.05);
  EXPECT_NEAR(box().width, 0.6, 0.05);
  EXPECT_NEAR(box().height(), 0.8, 0.05);
}

TEST_F(ObjectBoxTest, StraysAreOutside) {
  add({0, -0.8f, 1}, {1, 0, 1.6f}, small_room::kBox);
  add({3, -2.04f, 5}, {3.04f, -2, 5.04f}, small_room::kBox);
  EXPECT_NEAR(box().volume(0.01), 0.48, 0.05);
}

TEST_F(ObjectBoxTest, FaintGaussiansAreOutside) {
  add({0, -0.8f, 1}, {1, 0, 1.6f}, small_room::kBox);
  const auto [first, end] = add({2, -0.8f, 1}, {3, 0, 1.6f}, small_room::kBox);
  for (size_t i = first; i < end; ++i) room_.model.opacity_logits[i] = -3;
  EXPECT_NEAR(box().length, 1, 0.05);
}

TEST_F(ObjectBoxTest, TurnsAsTheThingIs) {
  add({-1, -0.8f, -0.3f}, {1, 0, 0.3f}, small_room::kBox);
  for (size_t i = 0; i < room_.model.size(); ++i) {
    float* p = &room_.model.positions[3 * i];
    const float x = p[0], z = p[2], h = std::sqrt(0.5f);
    p[0] = h * (x - z);
    p[2] = h * (x + z);
  }
  EXPECT_NEAR(box().length, 2, 0.06);
  EXPECT_NEAR(box().width, 0.6, 0.06);
}

TEST_F(ObjectBoxTest, TheMiddleIsThatOfTheFootprint) {
  add({2, -0.8f, 1}, {3, 0, 1.6f}, small_room::kBox);
  const BoxAxes axes({0, -1, 0});
  const Vec2d expected = axes.on_floor({2.5, 0, 1.3}), middle = box().middle();
  EXPECT_NEAR(middle.x, expected.x, 0.03);
  EXPECT_NEAR(middle.y, expected.y, 0.03);
}

}  // namespace
}  // namespace aligngs
