// The files of depth that the layouts read, and what is said when there are none.
#include "scene/import/testing/capture_folder.h"

namespace aligngs {
namespace {

using testing::Contains;
using testing::Eq;
using testing::HasSubstr;
using testing::Not;

class DepthFiles : public CaptureTest {
 protected:
  /// One frame of the RGB-D layout, without depth.
  void rgbd_frame() {
    image("images/a.png");
    write("poses/a.txt", pose_opencv());
    write("intrinsics.txt", "30 0 16\n0 30 12\n0 0 1\n");
  }
  /// Values of the first frame's depth; 0 where there is none.
  static float depth_of_first(const Capture& capture) {
    const ImageF depth = read_capture_depth(capture, capture.frames.at(0));
    return depth.empty() ? 0 : depth.at(5, 5);
  }
};

TEST_F(DepthFiles, CapitalsInTheFolderAndTheEndingAreFound) {
  rgbd_frame();
  depth("Depth/a.PNG", 2000);
  const Capture capture = read_capture(folder_);
  EXPECT_FLOAT_EQ(depth_of_first(capture), 2);
  EXPECT_THAT(capture.notes, Not(Contains(HasSubstr("depth"))));
}

TEST_F(DepthFiles, DepthOfAnotherKindIsNamed) {
  rgbd_frame();
  write("depth/a.tif", "II*");
  EXPECT_THAT(read_capture(folder_).notes,
              Contains(Eq("depth is not used: no frame has its depth/NAME.png; depth holds a.tif")));
}

TEST_F(DepthFiles, AMissingFolderOfDepthIsNamed) {
  rgbd_frame();
  EXPECT_THAT(read_capture(folder_).notes, Contains(Eq("depth is not used: no frame has its depth/NAME.png")));
}

TEST_F(DepthFiles, DepthThatSevenScenesCallsOtherwiseIsNamed) {
  image("frame-000000.color.png");
  write("frame-000000.pose.txt", pose_opencv());
  depth("frame-000000.depth.proj.png", 1000);
  EXPECT_THAT(read_capture(folder_, {.assume_registered = true}).notes,
              Contains(HasSubstr("no frame has its frame-NUMBER.depth.png")));
}

TEST_F(DepthFiles, OtherFilesOfTheFolderOfPhotosAreNotTakenForDepth) {
  image("results/frame000000.jpg", 60, 34);
  write("traj.txt", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n");
  EXPECT_THAT(read_capture(folder_).notes, Contains(Eq("depth is not used: no frame has its results/depthNUMBER.png")));
}

TEST_F(DepthFiles, TumWithoutAListOfDepthSaysSo) {
  image("rgb/a.png");
  write("rgb.txt", "1.0 rgb/a.png\n");
  write("groundtruth.txt", "1.0 0 0 0 0 0 0 1\n");
  write("k.txt", "30 30 15.5 11.5");
  EXPECT_THAT(read_capture(folder_, {.intrinsics = folder_ / "k.txt"}).notes,
              Contains(Eq("depth is not used: no frame has its file of depth.txt")));
}

}  // namespace
}  // namespace aligngs
