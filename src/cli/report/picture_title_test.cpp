#include "cli/report/picture_title.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace aligngs {
namespace {

size_t inked(const Image<uint8_t>& picture) {
  return static_cast<size_t>(
      std::count_if(picture.data.begin(), picture.data.end(), [](uint8_t v) { return v != 255; }));
}

TEST(PictureTitle, DrawsLettersIntoItsBand) {
  Image<uint8_t> picture(100, kTitleHeight + 10, 3, 255);
  draw_title(picture, 0, 0, "depth");
  EXPECT_GT(inked(picture), 100u);
  for (int y = kTitleHeight; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) EXPECT_EQ(picture.at(x, y, 0), 255);
  }
}

TEST(PictureTitle, CutsOffWhatLiesOutside) {
  Image<uint8_t> picture(9, 9, 3, 255);
  draw_title(picture, 0, 0, "normals");
  draw_title(picture, -30, -5, "normals");
  EXPECT_LT(inked(picture), picture.data.size());
}

TEST(PictureTitle, OtherCharactersAreBlanks) {
  Image<uint8_t> picture(100, kTitleHeight, 3, 255);
  draw_title(picture, 0, 0, "  0 A");
  EXPECT_EQ(inked(picture), 0u);
}

}  // namespace
}  // namespace aligngs
