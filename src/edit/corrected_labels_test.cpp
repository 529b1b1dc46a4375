#include "edit/corrected_labels.h"

#include <gmock/gmock.h>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

/// Two rows of books, one object by their labels, with crumbs between them.
class CorrectedLabels : public small_room::LabelledBoxes {
 protected:
  CorrectedLabels() {
    first_ = add({0, -0.28f, 0}, {0.8f, 0, 0.2f}, book_);
    second_ = add({0, -0.76f, 0}, {0.8f, -0.48f, 0.2f}, book_);
    crumbs_ = add({0, -0.44f, 0}, {0.8f, -0.32f, 0.2f}, book_, 0);
  }
  void correct(bool part_things) {
    LabelCorrections corrections;
    corrections.up = Vec3d{0, -1, 0};
    corrections.part_things = part_things;
    ThreadPool pool(2);
    correct_labels(room_, labels_, corrections, pool);
  }

  LabelSet labels_ = ade20k_labels();
  int book_ = labels_.find("book");
  std::pair<size_t, size_t> first_, second_, crumbs_;
};

using testing::AnyOf;
using testing::Each;

TEST_F(CorrectedLabels, CrumbsBetweenTwoThingsDoNotMakeThemOne) {
  correct(true);
  EXPECT_THAT(numbers(first_), Each(1));
  EXPECT_THAT(numbers(second_), Each(2));
}

TEST_F(CorrectedLabels, CrumbsJoinTheThingsAround) {
  correct(true);
  EXPECT_THAT(numbers(crumbs_), Each(AnyOf(1, 2)));
}

TEST_F(CorrectedLabels, ThingsThatSegmentsToldAreNotParted) {
  correct(false);
  EXPECT_THAT(numbers(first_), Each(1));
  EXPECT_THAT(numbers(second_), Each(1));
}

TEST_F(CorrectedLabels, WithoutLabelsNothingChanges) {
  room_.labels = {};
  room_.named = false;
  correct(true);
  EXPECT_TRUE(room_.labels.label.empty());
}

}  // namespace
}  // namespace aligngs
