#include "scene/photo_mask.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/jpeg_codec.h"
#include "io/testing/turned_jpeg.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class PhotoMask : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("mask_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
  }
  fs::path file(const std::string& name) {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << "x";
    return folder / name;
  }
  /// Only the upper left quarter counts.
  static Image<uint8_t> corner(int width, int height, uint8_t dark = 0, uint8_t bright = 255) {
    Image<uint8_t> mask(width, height, 1, dark);
    for (int y = 0; y < height / 2; ++y) {
      for (int x = 0; x < width / 2; ++x) mask.at(x, y) = bright;
    }
    return mask;
  }
  /// A photo of 40 x 20 stored pixels that was held on its side (orientation 6).
  fs::path turned_photo() {
    write_file_atomically(folder / "images/a.jpg", turned_jpeg(encode_jpeg(Image<uint8_t>(40, 20, 3, 90)), 6));
    return folder / "images/a.jpg";
  }
  fs::path folder;
};

TEST_F(PhotoMask, IsFoundByTheNamesOfColmapAndNerfstudio) {
  for (const char* name : {"masks/a.jpg.png", "masks/a.png", "masks/a.jpg"}) {
    const fs::path photo = file("images/a.jpg"), mask = file(name);
    EXPECT_EQ(find_mask(photo), mask);
    fs::remove(mask);
  }
  EXPECT_TRUE(find_mask(folder / "images/a.jpg").empty());
}

TEST_F(PhotoMask, KeepsTheSubfolderOfItsPhoto) {
  const fs::path left = file("images/left/a.jpg"), right = file("images/right/a.jpg"), mask = file("masks/left/a.png");
  EXPECT_EQ(find_mask(left), mask);
  EXPECT_TRUE(find_mask(right).empty());
}

TEST_F(PhotoMask, LiesBesidePhotosWithoutAFolderOfTheirOwn) {
  const fs::path photo = file("IMG_1.jpg"), mask = file("masks/IMG_1.png");
  EXPECT_EQ(find_mask(photo), mask);
}

TEST_F(PhotoMask, OfHalfTheSizeIsStretched) {
  write_png(folder / "images/a.png", Image<uint8_t>(40, 20, 3, 90));
  write_png(folder / "masks/a.png", corner(20, 10));
  const Image<uint8_t> mask = read_mask(folder / "masks/a.png", folder / "images/a.png", false, 40, 20);
  EXPECT_EQ(mask.at(19, 9), 255);
  EXPECT_EQ(mask.at(20, 9), 0);
  EXPECT_EQ(mask.at(19, 10), 0);
}

TEST_F(PhotoMask, ADarkValueOfAPngCountsAndOneOfAJpegDoesNot) {
  write_png(folder / "images/a.png", Image<uint8_t>(64, 64, 3, 90));
  write_png(folder / "masks/a.png", corner(64, 64, 0, 1));
  EXPECT_EQ(read_mask(folder / "masks/a.png", folder / "images/a.png", false, 64, 64).at(0, 0), 255);
  write_jpeg(folder / "masks/a.jpg", corner(64, 64, 10, 240), 95);
  const Image<uint8_t> mask = read_mask(folder / "masks/a.jpg", folder / "images/a.png", false, 64, 64);
  EXPECT_EQ(mask.at(4, 4), 255);
  EXPECT_EQ(mask.at(60, 60), 0);
}

TEST_F(PhotoMask, TurnsWithTheStoredPixels) {
  const fs::path photo = turned_photo();
  write_png(folder / "masks/a.png", corner(40, 20));
  EXPECT_EQ(read_mask(folder / "masks/a.png", photo, false, 40, 20).at(0, 0), 255);
  const Image<uint8_t> upright = read_mask(folder / "masks/a.png", photo, true, 20, 40);
  EXPECT_EQ(upright.at(19, 0), 255);  // a quarter clockwise: the upper left corner is the upper right one
  EXPECT_EQ(upright.at(0, 0), 0);
}

TEST_F(PhotoMask, OfTheUprightPhotoIsUsedAsItIs) {
  const fs::path photo = turned_photo();
  write_png(folder / "masks/a.png", corner(20, 40));
  EXPECT_EQ(read_mask(folder / "masks/a.png", photo, true, 20, 40).at(0, 0), 255);
  EXPECT_THROW(read_mask(folder / "masks/a.png", photo, false, 40, 20), Error);
}

TEST_F(PhotoMask, OfAnotherAspectIsRefused) {
  write_png(folder / "images/a.png", Image<uint8_t>(40, 20, 3, 90));
  write_png(folder / "masks/a.png", corner(30, 20));
  EXPECT_THROW(read_mask(folder / "masks/a.png", folder / "images/a.png", false, 40, 20), Error);
}

TEST_F(PhotoMask, AnyColourCounts) {
  write_png(folder / "images/a.png", Image<uint8_t>(8, 8, 3, 90));
  Image<uint8_t> blue(8, 8, 3, 0);
  blue.at(2, 2, 2) = 255;
  write_png(folder / "m.png", blue);
  const Image<uint8_t> mask = read_mask(folder / "m.png", folder / "images/a.png", false, 8, 8);
  EXPECT_EQ(mask.at(2, 2), 255);
  EXPECT_EQ(mask.at(3, 2), 0);
}

TEST_F(PhotoMask, OfBlackWithAlphaIsItsAlpha) {
  write_png(folder / "images/a.png", Image<uint8_t>(8, 8, 3, 90));
  Image<uint8_t> black(8, 8, 4, 0);
  black.at(2, 2, 3) = 255;
  write_png(folder / "m.png", black);
  const Image<uint8_t> mask = read_mask(folder / "m.png", folder / "images/a.png", false, 8, 8);
  EXPECT_EQ(mask.at(2, 2), 255);
  EXPECT_EQ(mask.at(3, 2), 0);
}

TEST_F(PhotoMask, SmallNumbersOfSixteenBitsCount) {
  write_png(folder / "images/a.png", Image<uint8_t>(8, 8, 3, 90));
  Image<uint16_t> small(8, 8, 1, 0);
  small.at(2, 2) = 1;
  write_png16(folder / "m.png", small);
  const Image<uint8_t> mask = read_mask(folder / "m.png", folder / "images/a.png", false, 8, 8);
  EXPECT_EQ(mask.at(2, 2), 255);
  EXPECT_EQ(mask.at(3, 2), 0);
}

}  // namespace
}  // namespace aligngs
