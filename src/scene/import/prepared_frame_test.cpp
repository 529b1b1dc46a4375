#include "scene/import/prepared_frame.h"

#include <gmock/gmock.h>

#include "core/testing/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/testing/turned_jpeg.h"
#include "scene/import/capture_frames.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A stored photo of 48 x 32 with depth of 32 x 48.
class DepthOfTurnedPhotos : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("prepared_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    write_png16(folder_ / "depth.png", Image<uint16_t>(32, 48, 1, 2000));
  }
  void write_photo(int orientation) const {
    const std::vector<uint8_t> jpeg = encode_jpeg(Image<uint8_t>(48, 32, 3, 90), 95);
    write_file_atomically(folder_ / "a.jpg", turned_jpeg(jpeg, orientation));
  }
  std::string error_with(int orientation) const {
    write_photo(orientation);
    CapturedFrame frame;
    frame.name = "a";
    frame.image = folder_ / "a.jpg";
    frame.depth = folder_ / "depth.png";
    frame.camera = pinhole_camera(40, 40, 24, 16, 48, 32);
    return error_of(ErrorKind::kBadInput, [&] { prepare_frame(Capture{}, frame, ImportOptions{}); });
  }
  fs::path folder_;
};

TEST_F(DepthOfTurnedPhotos, AnOrientationThatTurnsByAQuarterIsNamedAsTheCause) {
  for (const int orientation : {5, 6, 7, 8})
    EXPECT_THAT(error_with(orientation),
                AllOf(HasSubstr("32 x 48 has not the aspect of its image, 48 x 32"), HasSubstr("EXIF orientation")))
        << orientation;
}

TEST_F(DepthOfTurnedPhotos, AnotherOrientationIsNoCause) {
  for (const int orientation : {1, 3})
    EXPECT_THAT(error_with(orientation), AllOf(HasSubstr("has not the aspect"), Not(HasSubstr("EXIF")))) << orientation;
}

TEST_F(DepthOfTurnedPhotos, IntrinsicsOfTheUprightPictureNameTheOrientation) {
  write_photo(6);
  CapturedFrame frame;
  frame.image = folder_ / "a.jpg";
  EXPECT_THAT(error_of(ErrorKind::kBadInput,
                       [&] {
                         set_intrinsics(frame, {40, 40, 16, 24, 0, 0, {}});
                       }),
              HasSubstr("EXIF orientation turns it by a quarter"));
}

}  // namespace
}  // namespace aligngs
