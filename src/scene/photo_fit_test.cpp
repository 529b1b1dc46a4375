#include "scene/photo_fit.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace aligngs {
namespace {

/// A photo whose stored pixels are 400 x 300 and which was held as `orientation` says.
ImageInfo held(int orientation, int width = 400, int height = 300) {
  ImageInfo info;
  info.stored_width = info.width = width;
  info.stored_height = info.height = height;
  info.orientation = orientation;
  if (orientation >= 5) std::swap(info.width, info.height);
  return info;
}

TEST(PhotoFit, StoredPixelsAreUsedWhereTheyHaveTheCamerasSize) {
  for (int orientation = 1; orientation <= 8; ++orientation) {
    const auto fit = fit_photo(held(orientation), 400, 300);
    ASSERT_TRUE(fit) << orientation;
    EXPECT_FALSE(fit->upright) << orientation;
    EXPECT_EQ(fit->width, 400);
  }
}

TEST(PhotoFit, ACameraForTheUprightPictureGetsIt) {
  const auto fit = fit_photo(held(6), 300, 400);
  ASSERT_TRUE(fit);
  EXPECT_TRUE(fit->upright);
  EXPECT_EQ(fit->height, 400);
}

TEST(PhotoFit, AnyFactorThatKeepsTheAspectFits) {
  for (const auto& [width, height] :
       {std::pair(1600, 1200), std::pair(133, 100), std::pair(100, 75), std::pair(4000, 3000)}) {
    EXPECT_TRUE(fit_photo(held(1), width, height)) << width;
    EXPECT_TRUE(fit_photo(held(8), height, width)->upright) << width;
  }
  EXPECT_TRUE(fit_photo(held(1, 667, 1000), 4000, 6000));  // 666.7 rounded
}

TEST(PhotoFit, CropsAndQuarterTurnsDoNot) {
  EXPECT_FALSE(fit_photo(held(1), 400, 250));
  EXPECT_FALSE(fit_photo(held(1), 300, 400));
  EXPECT_THROW(require_photo_fit("a.jpg", held(1), 300, 400), Error);
  EXPECT_FALSE(fit_photo(held(1), 1, 1)) << "a pixel of rounding is not the whole camera";
}

}  // namespace
}  // namespace aligngs
