#include "scene/ignored_classes.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "scene/semantic_target.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Two classes at 40 x 20 pixels: the second one in [x0, x1) x [y0, y1).
SemanticTarget target_with(int x0, int x1, int y0, int y1) {
  constexpr int kWidth = 40, kHeight = 20;
  std::vector<float> values(2 * kWidth * kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool second = x >= x0 && x < x1 && y >= y0 && y < y1;
      values[size_t(y * kWidth + x)] = second ? 0.1f : 0.9f;
      values[size_t((kHeight + y) * kWidth + x)] = second ? 0.9f : 0.1f;
    }
  }
  SemanticConversion conversion;
  conversion.kind = SemanticKind::kProbabilities;
  return semantic_target(values.data(), 2, kWidth, kHeight, conversion);
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
  const Image<uint8_t> mask = mask_without(target_with(10, 20, 5, 15), {1}, 40, 20, options);
  EXPECT_EQ(mask.at(15, 10), 0);
  EXPECT_EQ(mask.at(8, 10), 0);
  EXPECT_EQ(mask.at(7, 10), 255);
  EXPECT_EQ(mask.at(15, 3), 0);
  EXPECT_EQ(mask.at(15, 2), 255);
}

TEST(MaskWithout, KeepsOtherClasses) {
  const Image<uint8_t> mask = mask_without(target_with(40, 40, 0, 0), {1}, 40, 20);
  EXPECT_THAT(mask.data, testing::Each(255));
}

TEST(MaskWithout, AStrayPixelIsNoPerson) {
  IgnoredRegionOptions options;
  options.least_share = 0.01;  // 8 of 800 pixels
  EXPECT_EQ(mask_without(target_with(10, 12, 5, 7), {1}, 40, 20, options).at(10, 5), 255);
  EXPECT_EQ(mask_without(target_with(10, 13, 5, 8), {1}, 40, 20, options).at(10, 5), 0);
}

TEST(MaskWithout, AClassEverywhereHidesEverything) {
  EXPECT_THAT(mask_without(target_with(0, 40, 0, 20), {1}, 40, 20).data, testing::Each(0));
}

}  // namespace
}  // namespace aligngs
