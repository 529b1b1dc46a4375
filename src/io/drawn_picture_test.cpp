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

TEST(DrawnPicture, OtherFilesBearNoMark) {
  const fs::path file = fs::path(testing::TempDir()) / "photo.png";
  write_png(file, Image<uint8_t>(5, 4, 3, 9));
  EXPECT_FALSE(has_drawn_mark(file));
  EXPECT_FALSE(has_drawn_mark(testing::TempDir()));
  EXPECT_FALSE(has_drawn_mark("/nowhere/at/all.png"));
}

}  // namespace
}  // namespace aligngs
