#include "io/drawn_picture.h"

#include <gtest/gtest.h>

#include "io/atomic_file.h"
#include "io/image_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

TEST(DrawnPicture, IsReadAsItWasDrawnAndBearsTheMark) {
  const fs::path file = fs::path(testing::TempDir()) / "drawn.png";
  Image<uint8_t> picture(5, 4, 3);
  for (size_t i = 0; i < picture.data.size(); ++i) picture.data[i] = static_cast<uint8_t>(4 * i);
  write_drawn_picture(file, picture);
  EXPECT_EQ(read_image(file).data, picture.data);
  EXPECT_TRUE(has_drawn_mark(file));
}

TEST(DrawnPicture, AJpegIsReadAsItWouldBeWithoutTheMark) {
  const fs::path marked = fs::path(testing::TempDir()) / "drawn.jpg",
                 plain = fs::path(testing::TempDir()) / "plain.jpg";
  Image<uint8_t> picture(16, 8, 3);
  for (size_t i = 0; i < picture.data.size(); ++i) picture.data[i] = static_cast<uint8_t>(i / 2);
  write_drawn_jpeg(marked, picture, 90);
  write_jpeg(plain, picture, 90);
  EXPECT_EQ(read_image(marked).data, read_image(plain).data);
  EXPECT_TRUE(has_drawn_mark(marked));
  EXPECT_FALSE(has_drawn_mark(plain));
}

TEST(DrawnPicture, OtherFilesBearNoMark) {
  const fs::path file = fs::path(testing::TempDir()) / "photo.png";
  write_png(file, Image<uint8_t>(5, 4, 3, 9));
  EXPECT_FALSE(has_drawn_mark(file));
  EXPECT_FALSE(has_drawn_mark(testing::TempDir()));
  EXPECT_FALSE(has_drawn_mark("/nowhere/at/all.png"));
}

}  // namespace
}  // namespace aligngs
