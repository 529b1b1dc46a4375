#include "scene/ignored_classes.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Two classes at 40 x 20 pixels: the second one in [x0, x1) x [y0, y1).
Image<uint16_t> labels_with(int x0, int x1, int y0, int y1) {
  Image<uint16_t> labels(40, 20, 1);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) labels.at(x, y) = 1;
  }
  return labels;
}

TEST(IgnoredClasses, AreNamesAndSynonymsWithCommas) {
  const LabelSet& labels = ade20k_labels();
  EXPECT_THAT(ignored_classes(labels, " dog,person , individual"),
              ElementsAre(labels.find("person"), labels.find("animal")));
  EXPECT_THAT(ignored_classes(labels, "people, Cat"), ElementsAre(labels.find("person"), labels.find("animal")));
  EXPECT_THAT(ignored_classes(labels, ""), IsEmpty());
}

TEST(IgnoredClasses, AnUnknownNameIsRefusedButNotTheDefault) {
  LabelSet rooms;
  rooms.name = "rooms";
  rooms.classes = {{"wall", {}, {}}};
  EXPECT_THAT(ignored_classes(rooms, kIgnoredByDefault), IsEmpty());
  EXPECT_THROW(ignored_classes(rooms, "person, wall"), Error);
  EXPECT_THROW(ignored_classes(ade20k_labels(), "unicorn"), Error);
}

TEST(MaskWithout, HidesTheClassAndABorder) {
  IgnoredRegionOptions options;
  options.border = 0.05;  // 2 of 40 pixels
  const Image<uint8_t> mask = mask_without(labels_with(10, 20, 5, 15), {1}, options);
  EXPECT_EQ(mask.at(15, 10), 0);
  EXPECT_EQ(mask.at(8, 10), 0);
  EXPECT_EQ(mask.at(7, 10), 255);
  EXPECT_EQ(mask.at(15, 3), 0);
  EXPECT_EQ(mask.at(15, 2), 255);
}

TEST(MaskWithout, KeepsOtherClasses) {
  const Image<uint8_t> mask = mask_without(labels_with(40, 40, 0, 0), {1});
  EXPECT_THAT(mask.data, testing::Each(255));
}

TEST(MaskWithout, AStrayPixelIsNoPerson) {
  IgnoredRegionOptions options;
  options.least_share = 0.01;  // 8 of 800 pixels
  EXPECT_EQ(mask_without(labels_with(10, 12, 5, 7), {1}, options).at(10, 5), 255);
  EXPECT_EQ(mask_without(labels_with(10, 13, 5, 8), {1}, options).at(10, 5), 0);
}

TEST(MaskWithout, AClassEverywhereHidesEverything) {
  EXPECT_THAT(mask_without(labels_with(0, 40, 0, 20), {1}).data, testing::Each(0));
}

}  // namespace
}  // namespace aligngs
