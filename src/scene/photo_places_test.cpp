#include "scene/photo_places.h"

#include <gmock/gmock.h>

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class PhotoPlaces : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(testing::TempDir()) / "photo_places" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "sparse" / "0");
  }
  fs::path folder_;
};

TEST_F(PhotoPlaces, TheLargestShrunkPhotosStandForMissingOnes) {
  EXPECT_EQ(images_folder(folder_), "");
  for (const char* name : {"images_8", "images_4", "images_other"}) fs::create_directories(folder_ / name);
  EXPECT_EQ(images_folder(folder_), folder_ / "images_4");
  fs::create_directories(folder_ / "images");
  EXPECT_EQ(images_folder(folder_), folder_ / "images");
}

TEST_F(PhotoPlaces, PhotosOfScanNetppAreThoseOfItsModel) {
  for (const char* name : {"resized_images", "resized_undistorted_images"}) fs::create_directories(folder_ / name);
  EXPECT_EQ(images_folder(folder_), folder_ / "resized_images");
  EXPECT_TRUE(fits_other_cameras(folder_ / "resized_undistorted_images"));
  EXPECT_FALSE(fits_other_cameras(folder_ / "resized_images"));
}

TEST_F(PhotoPlaces, TheModelOfADataSetNamesTheDataSet) {
  EXPECT_EQ(data_set_around(folder_ / "sparse" / "0"), "");
  EXPECT_THAT(missing_photos_remedy(folder_ / "sparse"), testing::HasSubstr("into images/"));
  fs::create_directories(folder_ / "images");
  for (const fs::path& model : {folder_ / "sparse", folder_ / "sparse" / "0", folder_ / "sparse" / "0" / ""}) {
    EXPECT_EQ(data_set_around(model), folder_) << model;
    EXPECT_THAT(missing_photos_remedy(model), testing::HasSubstr(folder_.string())) << model;
  }
  EXPECT_THAT(missing_photos_remedy(folder_), testing::HasSubstr("into images/"));
}

}  // namespace
}  // namespace aligngs
