#include "edit/object_choice.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace aligngs {
namespace {

/// An object whose box has edges of `size` metres.
Instance object(const char* name, int number, const Vec3f& centre, float size) {
  Instance o;
  o.label = ade20k_labels().find(name);
  o.number = number;
  o.gaussians = 100;
  o.centre = centre;
  o.low = centre - Vec3f{size / 2, size / 2, size / 2};
  o.high = centre + Vec3f{size / 2, size / 2, size / 2};
  return o;
}

/// Up is -y as in a camera's world; the cameras look along +z, so that +x is on the right.
class ObjectChoiceTest : public testing::Test {
 protected:
  std::string chosen(const std::string& text) const {
    const Vocabulary vocabulary(ade20k_labels());
    return selection_text(with_numbers(parse_selection(text, vocabulary), objects_, viewpoint_, ade20k_labels()),
                          ade20k_labels());
  }
  std::vector<Instance> objects_ = {object("chair", 1, {0, 0, 2}, 0.5f), object("chair", 2, {1, 0, 3}, 0.9f),
                                    object("pillow", 1, {0.5f, -0.6f, 2}, 0.4f),
                                    object("pillow", 2, {-0.5f, -0.5f, 2}, 0.4f), object("bed", 1, {0, 0, 2.5f}, 2)};
  Viewpoint viewpoint_{Vec3d{0, -1, 0}, Vec3d{0, -1.5, -1}};
};

TEST_F(ObjectChoiceTest, SizeIsThatOfTheBoxAndNotTheNumberOfGaussians) {
  EXPECT_EQ(chosen("the largest chair"), "chair#2");
  EXPECT_EQ(chosen("smallest chair"), "chair#1");
}

TEST_F(ObjectChoiceTest, LeftIsAsThePhotosSeeIt) {
  EXPECT_EQ(chosen("the left pillow"), "pillow#2");
  EXPECT_EQ(chosen("rightmost pillow"), "pillow#1");
}

TEST_F(ObjectChoiceTest, HighAndLowFollowTheUpDirection) {
  EXPECT_EQ(chosen("highest pillow"), "pillow#1");
  EXPECT_EQ(chosen("lowest pillow"), "pillow#2");
}

TEST_F(ObjectChoiceTest, AnExceptionCanBeAChoice) {
  EXPECT_EQ(chosen("every chair but the largest chair"), "chair but chair#2");
}

TEST_F(ObjectChoiceTest, OneObjectNeedsNoDirection) {
  viewpoint_ = {};
  EXPECT_EQ(chosen("the left bed"), "bed#1");
  EXPECT_THROW(chosen("the left pillow"), Error);
}

TEST_F(ObjectChoiceTest, AClassThatTheRoomLacksIsNamed) {
  try {
    chosen("the largest sofa");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_THAT(error.what(), testing::HasSubstr("sofa"));
  }
}

}  // namespace
}  // namespace aligngs
