// The extrinsics of ScanNet's export.
#include <gmock/gmock.h>

#include "core/testing/error.h"
#include "scene/import/testing/capture_folder.h"

namespace aligngs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kIdentityMatrix = "1.000000 0 0 0\n0 1.000000 0 0\n0 0 1.000000 0\n0 0 0 1\n";

/// One frame whose depth camera is the colour camera at half the size.
class ScanNetExtrinsics : public CaptureTest {
 protected:
  void SetUp() override {
    CaptureTest::SetUp();
    image("color/0.jpg", 64, 48);
    depth("depth/0.png", 2000);
    write("pose/0.txt", pose_opencv());
    write("intrinsic/intrinsic_color.txt", "60 0 31.5 0\n0 60 23.5 0\n0 0 1 0\n0 0 0 1\n");
    write("intrinsic/intrinsic_depth.txt", "30 0 15.5 0\n0 30 11.5 0\n0 0 1 0\n0 0 0 1\n");
  }
  Capture read(const std::string& color, const std::string& depth) {
    write("intrinsic/extrinsic_color.txt", color);
    write("intrinsic/extrinsic_depth.txt", depth);
    return read_capture(folder_);
  }
  static std::string moved(const std::string& x) { return "1 0 0 " + x + "\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"; }
};

TEST_F(ScanNetExtrinsics, IdentitiesGiveNoWarning) {
  EXPECT_THAT(read(kIdentityMatrix, kIdentityMatrix).notes, IsEmpty());
}

TEST_F(ScanNetExtrinsics, AnotherColourExtrinsicGivesOneWarning) {
  EXPECT_THAT(read(moved("0.02"), kIdentityMatrix).notes,
              ElementsAre(AllOf(HasSubstr("extrinsic_color.txt is not the identity"),
                                HasSubstr("poses are taken as those of the colour camera"),
                                HasSubstr("pose * extrinsic_color"))));
}

TEST_F(ScanNetExtrinsics, PosesStayThoseOfTheColourCamera) {
  const Capture capture = read(moved("0.02"), kIdentityMatrix);
  ASSERT_EQ(capture.frames.size(), 1u);
  EXPECT_NEAR(norm(capture.frames[0].world_to_camera.inverse().translation - Vec3d{1, 2, 3}), 0, 1e-12);
}

TEST_F(ScanNetExtrinsics, AColourExtrinsicIsTakenOutOfTheDepthCamera) {
  const Capture capture = read(moved("0.02"), moved("0.05"));
  ASSERT_TRUE(capture.depth_camera);
  EXPECT_NEAR(capture.depth_camera->to_color.translation.x, 0.03, 1e-12);
}

TEST_F(ScanNetExtrinsics, AMissingColourExtrinsicCountsAsTheIdentity) {
  write("intrinsic/extrinsic_depth.txt", moved("0.05"));
  const Capture capture = read_capture(folder_);
  ASSERT_TRUE(capture.depth_camera);
  EXPECT_NEAR(capture.depth_camera->to_color.translation.x, 0.05, 1e-12);
}

TEST_F(ScanNetExtrinsics, TranslationsThatAreNotInMetresAreRefused) {
  for (const char* x : {"5", "50"}) {  // centimetres and millimetres
    EXPECT_THAT(error_of(ErrorKind::kBadInput, [&] { read(kIdentityMatrix, moved(x)); }),
                AllOf(HasSubstr("extrinsic_depth.txt"), HasSubstr("m apart"), HasSubstr("in metres")))
        << x;
  }
}

}  // namespace
}  // namespace aligngs
