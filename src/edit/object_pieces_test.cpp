#include "edit/object_pieces.h"

#include <gmock/gmock.h>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

constexpr int kBedClass = 7, kChair = 19, kLamp = 36, kBook = 67, kSwivelChair = 75, kBlanket = 131,
              kSconce = 134;  // ADE20K classes

class ObjectPieces : public small_room::LabelledBoxes {
 protected:
  size_t join(const std::optional<Vec3d>& up = Vec3d{0, -1, 0}) {
    return join_object_pieces(room_, ade20k_labels(), up);
  }
  std::vector<std::pair<int, int>> objects() const {
    std::vector<std::pair<int, int>> out;
    for (const Instance& o : list_instances(room_.model, room_.labels)) out.emplace_back(o.label, o.number);
    return out;
  }
};

using testing::ElementsAre;
using testing::Pair;

TEST_F(ObjectPieces, TheFootOfASwivelChairIsOfTheChair) {
  add({-0.3f, -1.0f, -0.3f}, {0.3f, -0.4f, 0.3f}, kSwivelChair, 1);
  add({-0.2f, -0.2f, -0.2f}, {0.2f, 0, 0.2f}, kSwivelChair, 2);  // 20 cm below the seat
  EXPECT_EQ(join(), 1u);
  EXPECT_THAT(objects(), ElementsAre(Pair(kSwivelChair, 1)));
}

TEST_F(ObjectPieces, ABlanketDividesNoBed) {
  add({-0.8f, -0.4f, 0}, {0.8f, 0, 0.8f}, kBedClass, 1);
  add({-0.8f, -0.4f, 1.3f}, {0.8f, 0, 2.0f}, kBedClass, 2);  // more than a piece of the other one
  add({-0.85f, -0.42f, 0.78f}, {0.85f, 0, 1.32f}, kBlanket, 1);
  EXPECT_EQ(join(), 1u);
  EXPECT_THAT(objects(), ElementsAre(Pair(kBedClass, 1), Pair(kBlanket, 1)));
}

TEST_F(ObjectPieces, TwoBedsWithBlanketsOfTheirOwnStay) {
  add({-1.4f, -0.4f, 0}, {-0.5f, 0, 1.8f}, kBedClass, 1);
  add({0.5f, -0.4f, 0}, {1.4f, 0, 1.8f}, kBedClass, 2);
  add({-1.4f, -0.44f, 0}, {-0.5f, -0.4f, 0.6f}, kBlanket, 1);
  add({0.5f, -0.44f, 0}, {1.4f, -0.4f, 0.6f}, kBlanket, 2);
  EXPECT_EQ(join(), 0u);
}

TEST_F(ObjectPieces, AChairBesideAnotherOneStays) {
  add({-0.3f, -1.0f, -0.3f}, {0.3f, -0.4f, 0.3f}, kSwivelChair, 1);
  add({0.4f, -0.4f, -0.2f}, {0.8f, 0, 0.2f}, kSwivelChair, 2);
  EXPECT_EQ(join(), 0u);
}

TEST_F(ObjectPieces, AThingFarBelowStays) {
  add({-0.3f, -2.0f, -0.3f}, {0.3f, -1.4f, 0.3f}, kSwivelChair, 1);
  add({-0.2f, -0.2f, -0.2f}, {0.2f, 0, 0.2f}, kSwivelChair, 2);  // 1.2 m below
  EXPECT_EQ(join(), 0u);
}

TEST_F(ObjectPieces, AThingOfEqualSizeStays) {
  add({-0.2f, -0.9f, -0.2f}, {0.2f, -0.5f, 0.2f}, kChair, 1);
  add({-0.2f, -0.36f, -0.2f}, {0.2f, 0, 0.2f}, kChair, 2);
  EXPECT_EQ(join(), 0u);
}

TEST_F(ObjectPieces, TwoNamesForOneLampAreOneLamp) {
  add({-0.2f, -0.8f, -0.1f}, {0, -0.5f, 0.1f}, kLamp, 1);
  add({0.02f, -0.8f, -0.1f}, {0.1f, -0.5f, 0.1f}, kSconce, 1);  // the front of its shade
  EXPECT_EQ(join(), 1u);
  EXPECT_THAT(objects(), ElementsAre(Pair(kLamp, 1)));
}

TEST_F(ObjectPieces, BooksAboveBooksStay) {
  add({-0.3f, -1.0f, -0.3f}, {0.3f, -0.4f, 0.3f}, kBook, 1);
  add({-0.2f, -0.2f, -0.2f}, {0.2f, 0, 0.2f}, kBook, 2);
  EXPECT_EQ(join(), 0u);
}

TEST_F(ObjectPieces, WithoutAnUpDirectionNothingJoins) {
  add({-0.3f, -1.0f, -0.3f}, {0.3f, -0.4f, 0.3f}, kSwivelChair, 1);
  add({-0.2f, -0.2f, -0.2f}, {0.2f, 0, 0.2f}, kSwivelChair, 2);
  EXPECT_EQ(join({}), 0u);
}

}  // namespace
}  // namespace aligngs
