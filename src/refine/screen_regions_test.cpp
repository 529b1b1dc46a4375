#include "refine/screen_regions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "refine/testing/screen_room.h"

namespace aligngs {
namespace {

using namespace screen_room;

std::vector<ScreenRegion> regions_of(const ScreenPhoto& p) {
  return screen_regions(p.view, 3, luma_gradient(p.luma), kScreenClasses, {});
}

TEST(ScreenRegions, AScreenIsOneWithItsDepthAndDirection) {
  const std::vector<ScreenRegion> regions = regions_of(photo(camera(0.2, -0.2, 0), Screen{}));
  ASSERT_EQ(regions.size(), 1u);
  EXPECT_EQ(regions[0].view, 3u);
  EXPECT_NEAR(regions[0].depth, kStanding, 0.01);
  EXPECT_NEAR(regions[0].normal.z, -1, 1e-3);
  EXPECT_GT(regions[0].outline.size(), 40u);
}

TEST(ScreenRegions, PiecesThatDoNotTouchAreTwo) {
  ScreenPhoto p = photo(camera(0, -0.2, 0), Screen{});
  for (int y = 0; y < kPhotoHeight; ++y) {
    for (int x = kPhotoWidth / 2 - 2; x < kPhotoWidth / 2 + 2; ++x) p.view.labels.at(x, y) = kOtherLabel;
  }
  EXPECT_EQ(regions_of(p).size(), 2u);
}

TEST(ScreenRegions, SpecksAndWhatHasNoDepthAreLeftOut) {
  ScreenPhoto p = photo(camera(0, -0.2, 0), Screen{});
  ScreenPhoto speck = p;
  std::fill(speck.view.labels.data.begin(), speck.view.labels.data.end(), kOtherLabel);
  for (int x = 100; x < 108; ++x) speck.view.labels.at(x, 100) = kScreenLabel;
  EXPECT_TRUE(regions_of(speck).empty());
  std::fill(p.view.depth.data.begin(), p.view.depth.data.end(), 0.0f);
  EXPECT_TRUE(regions_of(p).empty());
  p.view.labels = {};
  EXPECT_TRUE(regions_of(p).empty());
}

}  // namespace
}  // namespace aligngs
