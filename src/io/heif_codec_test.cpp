#include "io/heif_codec.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/exif_focal_length.h"
#include "io/image_file.h"

namespace aligngs {
namespace {

const std::filesystem::path kPictures = std::filesystem::path(ALIGNGS_SOURCE_DIR) / "tests/data/pictures";

class Heif : public testing::Test {
 protected:
  void SetUp() override {
    if (!can_decode_heif()) GTEST_SKIP() << "built without libheif";
  }
};

/// Grey of the block in that column and row, from its middle.
int block(const Image<uint8_t>& image, int column, int row) { return image.at(32 * column + 16, 32 * row + 16, 1); }

TEST_F(Heif, BlocksComeOutInTheirPlaces) {
  const Image<uint8_t> image = read_image(kPictures / "plain.heic");
  ASSERT_EQ(image.width, 64);
  ASSERT_EQ(image.height, 96);
  ASSERT_EQ(image.channels, 3);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 2; ++column) EXPECT_NEAR(block(image, column, row), 20 + 40 * (column + 2 * row), 3);
  }
}

TEST_F(Heif, TheFilesOwnTurnIsAppliedAndNoOther) {
  const Image<uint8_t> image = read_image(kPictures / "turned.heic");
  ASSERT_EQ(image.width, 96);
  ASSERT_EQ(image.height, 64);
  EXPECT_NEAR(block(image, 0, 0), 180, 3);  // a quarter clockwise: the lower left block is the upper left one
  EXPECT_NEAR(block(image, 2, 1), 60, 3);
  const ImageInfo info = read_image_info(kPictures / "turned.heic");
  EXPECT_EQ(info.width, 96);
  EXPECT_EQ(info.stored_width, 96);
  EXPECT_EQ(info.orientation, 1);
}

TEST_F(Heif, TransparencyIsAFourthChannel) {
  const Image<uint8_t> image = read_image(kPictures / "alpha.heic");
  ASSERT_EQ(image.channels, 4);
  EXPECT_GT(image.at(16, 48, 3), 250);
  EXPECT_LT(image.at(48, 48, 3), 5);
}

TEST_F(Heif, AvifIsReadAsWell) {
  const Image<uint8_t> image = read_image(kPictures / "plain.avif");
  ASSERT_EQ(image.width, 64);
  EXPECT_NEAR(block(image, 1, 2), 220, 3);
}

TEST_F(Heif, TheFocalLengthOfTheCameraIsFound) {
  const std::string bytes = read_file(kPictures / "plain.heic");
  const auto focal = exif_focal_35mm(exif_of_picture(bytes, ""), 96);
  ASSERT_TRUE(focal.has_value());
  EXPECT_EQ(*focal, 28);
}

TEST_F(Heif, ACutFileIsRefused) {
  const std::string whole = read_file(kPictures / "plain.heic");
  for (const size_t keep : {whole.size() - 1, whole.size() / 2, size_t(40), size_t(12)}) {
    EXPECT_THROW(decode_image(whole.substr(0, keep), "photo"), Error) << keep;
    EXPECT_FALSE(has_end_of_heif(whole.substr(0, keep))) << keep;
  }
}

TEST(HeifWithoutLibrary, IsNamedInTheError) {
  if (can_decode_heif()) GTEST_SKIP() << "built with libheif";
  try {
    read_image(kPictures / "plain.heic");
    FAIL() << "read";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("libheif"), std::string::npos);
  }
}

}  // namespace
}  // namespace aligngs
