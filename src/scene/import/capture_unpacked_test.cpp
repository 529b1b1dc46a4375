// Captures as people unpack, thin out and convert them.
#include "core/error.h"
#include "scene/import/testing/capture_folder.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class UnpackedTest : public CaptureTest {
 protected:
  static constexpr const char* kLens = "30 0 16\n0 30 12\n0 0 1\n";

  void seven_scenes_frame(const std::string& stem) {
    image(stem + ".color.png");
    write(stem + ".pose.txt", pose_opencv());
  }
  Capture read_seven_scenes_folder() {
    write("k.txt", kLens);
    return read_capture(folder_, {.intrinsics = folder_ / "k.txt"});
  }
  std::string error_of_reading() {
    try {
      read_capture(folder_);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  void scannet_frame(const std::string& name) {
    image("color/" + name + ".jpg");
    write("pose/" + name + ".txt", pose_opencv());
  }
};

TEST_F(UnpackedTest, SequencesInAFolderOfTheirOwnNameAreFound) {
  seven_scenes_frame("seq-01/seq-01/frame-000000");
  EXPECT_EQ(read_seven_scenes_folder().frames.size(), 1u);
}

TEST_F(UnpackedTest, ASequenceThatIsStillPackedIsNamed) {
  seven_scenes_frame("seq-01/frame-000000");
  write("seq-01.zip", "PK");
  write("seq-02.zip", "PK");
  EXPECT_THAT(read_seven_scenes_folder().notes,
              testing::Contains("seq-02.zip is not unpacked: its frames are not used"));
  EXPECT_THAT(read_seven_scenes_folder().notes, testing::Not(testing::Contains(HasSubstr("seq-01"))));
}

TEST_F(UnpackedTest, APoseOfSevenScenesWithoutItsPhotoIsListed) {
  seven_scenes_frame("seq-01/frame-000000");
  write("seq-01/frame-000001.pose.txt", pose_opencv());
  EXPECT_THAT(reasons(read_seven_scenes_folder()), ElementsAre("frame-000001: the photo is missing"));
}

TEST_F(UnpackedTest, AFolderOfArchivesSaysSo) {
  write("seq-01.zip", "PK");
  write("seq-02.zip", "PK");
  EXPECT_THAT(error_of_reading(), HasSubstr("holds archives: seq-01.zip, seq-02.zip"));
}

TEST_F(UnpackedTest, AFinishedModelIsNoCapture) {
  write("scan.spz", "x");
  write("scan.usdz", "x");
  EXPECT_THAT(error_of_reading(), HasSubstr("a finished model (scan.spz, scan.usdz)"));
}

TEST_F(UnpackedTest, PhotosAloneAreSentToPoses) {
  image("images/a.jpg");
  EXPECT_THAT(error_of_reading(), AllOf(HasSubstr("photos without cameras (a.jpg)"), HasSubstr("`aligngs poses`")));
}

TEST_F(UnpackedTest, AVideoIsSentToRun) {
  write("IMG_1.MOV", "x");
  EXPECT_THAT(error_of_reading(), AllOf(HasSubstr("videos: IMG_1.MOV"), HasSubstr("`aligngs run VIDEO")));
  try {
    read_capture(folder_ / "IMG_1.MOV");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("this is a video"));
  }
}

TEST_F(UnpackedTest, ExportsOfOtherProgramsAreNamed) {
  for (const auto& [file, name] : {std::pair{"reconstruction.json", "OpenSfM"},
                                   {"cfg_args", "Gaussian splats"},
                                   {"meta_data.json", "SDFStudio"},
                                   {"cameras.json", "Gaussian splats"}}) {
    write(file, "x");
    EXPECT_THAT(error_of_reading(), HasSubstr(name));
    std::filesystem::remove(folder_ / file);
  }
}

TEST_F(UnpackedTest, OneOfSeveralModelsFindsThePhotosBesideIt) {
  image("images/rig/a.png");
  for (const char* model : {"calibration_jpg", "calibration_undistorted"}) {
    write(std::string(model) + "/cameras.txt", "1 PINHOLE 32 24 30 30 16 12\n");
    write(std::string(model) + "/images.txt", "1 1 0 0 0 0 0 0 1 rig/a.png\n\n");
  }
  EXPECT_THAT(error_of_reading(), HasSubstr("calibration_undistorted (COLMAP)"));
  const Capture capture = read_capture(folder_ / "calibration_jpg");
  ASSERT_EQ(capture.frames.size(), 1u);
  EXPECT_EQ(capture.frames[0].image, folder_ / "images" / "rig" / "a.png");
}

TEST_F(UnpackedTest, TwoPhotosOfOneNameAreBothNamed) {
  image("images/a.png");
  image("images/a.jpg");
  write("sparse/cameras.txt", "1 PINHOLE 32 24 30 30 16 12\n");
  write("sparse/images.txt", "1 1 0 0 0 0 0 0 1 a.png\n\n2 1 0 0 0 1 0 0 1 a.jpg\n\n");
  EXPECT_THAT(reasons(read_capture(folder_)),
              ElementsAre("a: two images have this name before the last dot: a.png and a.jpg"));
}

TEST_F(UnpackedTest, AFileOfRecord3dIsNamed) {
  write("room.r3d", "PK");
  try {
    read_capture(folder_ / "room.r3d");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("a capture of Record3D"));
  }
}

TEST_F(UnpackedTest, ScanNetsBenchmarkFramesHaveTheirIntrinsicsInTheFolder) {
  scannet_frame("0");
  write("intrinsics_color.txt", "30 0 15.5 0\n0 31 11.5 0\n0 0 1 0\n0 0 0 1\n");
  const Capture capture = read_capture(folder_);
  ASSERT_EQ(capture.frames.size(), 1u);
  EXPECT_THAT(capture.frames[0].camera.params, ElementsAre(30, 31, 16, 12));
}

TEST_F(UnpackedTest, ScanNetWithoutIntrinsicsNamesThem) {
  scannet_frame("0");
  EXPECT_THAT(error_of_reading(), HasSubstr("intrinsic_color.txt: the intrinsics of the colour camera are missing"));
}

TEST_F(UnpackedTest, ScanNetsDepthSensorHasIntrinsicsOfItsOwn) {
  scannet_frame("0");
  write("intrinsic/intrinsic_color.txt", "30 0 15.5 0\n0 31 11.5 0\n0 0 1 0\n0 0 0 1\n");
  const auto error_with = [&](const std::string& depth) {
    write("intrinsic/intrinsic_depth.txt", depth);
    return error_of_reading();
  };
  EXPECT_THAT(error_with("-30 0 15.5 0\n0 31 11.5 0\n0 0 1 0\n0 0 0 1\n"),
              HasSubstr("intrinsic_depth.txt: matrix: focal lengths must be positive"));
  EXPECT_THAT(error_with("30 0 0 0\n0 31 0 0\n15.5 11.5 1 0\n0 0 0 1\n"), HasSubstr("column-major"));
}

TEST_F(UnpackedTest, AScanNetPhotoWithoutPoseIsListed) {
  scannet_frame("0");
  image("color/10.jpg");
  write("intrinsic/intrinsic_color.txt", "30 0 15.5 0\n0 31 11.5 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_THAT(reasons(read_capture(folder_)), ElementsAre("10: pose/10.txt: it has no pose"));
}

TEST_F(UnpackedTest, ScanNetPhotosOfAnotherSizeThanTheirIntrinsicsAreRefused) {
  image("color/0.jpg", 48, 36);
  write("pose/0.txt", pose_opencv());
  write("intrinsic/intrinsic_color.txt", "60 0 31.5 0\n0 60 23.5 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("the middle of photos of about 64 x 48, and this is a photo of 48 x 36"));
}

TEST_F(UnpackedTest, ReplicaPhotosOfAnotherNameAreRefused) {
  image("results/rgb000000.jpg", 60, 34);
  write("traj.txt", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n");
  EXPECT_THAT(error_of_reading(), HasSubstr("no photos called frame*.jpg"));
}

}  // namespace
}  // namespace aligngs
