#include "scene/import/capture.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <functional>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/import/capture_text.h"
#include "scene/import/view_selection.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kWidth = 32, kHeight = 24;

/// A small folder for one test; the layouts differ, the two cameras do not.
class CaptureTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("capture_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

  void write(const std::string& name, const std::string& text) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  void image(const std::string& name, int width = kWidth, int height = kHeight) {
    fs::create_directories((folder_ / name).parent_path());
    const Image<uint8_t> picture(width, height, 3, 90);
    name.find(".jpg") != std::string::npos ? write_jpeg(folder_ / name, picture) : write_png(folder_ / name, picture);
  }
  void depth(const std::string& name, uint16_t value, int width = kWidth, int height = kHeight) {
    fs::create_directories((folder_ / name).parent_path());
    Image<uint16_t> map(width, height, 1, value);
    map.at(0, 0) = 0;
    map.at(1, 0) = 65535;
    write_png16(folder_ / name, map);
  }
  /// Camera-to-world of camera 0: at (1, 2, 3), turned a quarter about z; OpenCV axes.
  static std::string pose_opencv() { return "0 -1 0 1\n1 0 0 2\n0 0 1 3\n0 0 0 1\n"; }
  static std::string pose_opengl() { return "0 1 0 1\n1 0 0 2\n0 0 -1 3\n0 0 0 1\n"; }
  static std::string pose_lost(const char* word) {
    std::string row = fmt::format("{0} {0} {0} {0}\n", word);
    return row + row + row + row;
  }
  void expect_one_known_camera(const Capture& capture) {
    ASSERT_EQ(capture.frames.size(), 1u);
    const Rigidd& pose = capture.frames[0].world_to_camera;
    EXPECT_NEAR(norm(pose.inverse().translation - Vec3d{1, 2, 3}), 0, 1e-12);
    EXPECT_NEAR(norm(pose * Vec3d{1, 2, 5} - Vec3d{0, 0, 2}), 0, 1e-12);  // straight ahead
    EXPECT_NEAR(norm(pose * Vec3d{1, 3, 3} - Vec3d{1, 0, 0}), 0, 1e-12);  // to the right
    EXPECT_EQ(capture.frames[0].camera.width, uint64_t(kWidth));
  }

  /// "name: reason" of each frame that is left out.
  static std::vector<std::string> reasons(const Capture& capture) {
    std::vector<std::string> lines;
    for (const LeftOut& frame : capture.left_out) lines.push_back(frame.name + ": " + frame.reason);
    return lines;
  }

  fs::path folder_;
};

TEST_F(CaptureTest, ReadsAnRgbdFolderWithItsSplit) {
  for (const char* name : {"a", "b"}) {
    image(fmt::format("images/{}.jpg", name));
    depth(fmt::format("depth/{}.png", name), 2500);
  }
  write("poses/a.txt", pose_opencv());
  write("poses/b.txt", pose_lost("nan"));
  write("intrinsics.txt", "30 0 16\n0 31 12\n0 0 1\n");
  write("train.txt", "a\n");
  write("test.txt", "b\n");
  write("reference_mesh.ply", "ply");
  const Capture capture = read_capture(folder_);
  EXPECT_EQ(capture.layout, "rgbd");
  expect_one_known_camera(capture);
  EXPECT_THAT(reasons(capture), ElementsAre(HasSubstr("b: poses/b.txt, matrix: lost tracking")));
  EXPECT_THAT(capture.train, ElementsAre("a"));
  EXPECT_TRUE(capture.metric);
  EXPECT_EQ(capture.mesh.filename(), "reference_mesh.ply");
  EXPECT_THAT(capture.frames[0].camera.params, ElementsAre(30, 31, 16, 12));
  const ImageF map = read_capture_depth(capture, capture.frames[0]);
  EXPECT_FLOAT_EQ(map.at(5, 5), 2.5f);
  EXPECT_EQ(map.at(0, 0), 0);
  EXPECT_EQ(map.at(1, 0), 0);
}

TEST_F(CaptureTest, ReadsScanNetAndBringsDepthToTheColourCamera) {
  image("color/0.jpg", 64, 48);
  image("color/10.jpg", 64, 48);
  depth("depth/0.png", 2000);
  write("pose/0.txt", pose_opencv());
  write("pose/10.txt", pose_lost("-inf"));
  const std::string identity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  write("intrinsic/intrinsic_color.txt", "60 0 31.5 0\n0 60 23.5 0\n0 0 1 0\n0 0 0 1\n");
  write("intrinsic/intrinsic_depth.txt", "30 0 15.5 0\n0 30 11.5 0\n0 0 1 0\n0 0 0 1\n");
  write("intrinsic/extrinsic_color.txt", identity);
  write("intrinsic/extrinsic_depth.txt", identity);
  const Capture capture = read_capture(folder_);
  EXPECT_EQ(capture.layout, "scannet");
  ASSERT_EQ(capture.frames.size(), 1u);
  EXPECT_THAT(capture.frames[0].camera.params, ElementsAre(60, 60, 32, 24));
  EXPECT_THAT(reasons(capture), ElementsAre(HasSubstr("10: ")));
  const ImageF map = read_capture_depth(capture, capture.frames[0]);
  EXPECT_FLOAT_EQ(map.at(20, 20), 2.f);  // same rays at half size: every sample stays at its pixel
  EXPECT_EQ(map.at(0, 0), 0);
}

TEST_F(CaptureTest, ReadsNeuralRgbdInOpenGlAxes) {
  image("images/img0.png");
  image("images/img1.png");
  depth("depth/depth0.png", 1000);
  write("focal.txt", "28.5\n");
  write("poses.txt", pose_opengl() + pose_lost("nan"));
  const Capture capture = read_capture(folder_);
  EXPECT_EQ(capture.layout, "nrgbd");
  expect_one_known_camera(capture);
  EXPECT_THAT(capture.frames[0].camera.params, ElementsAre(28.5, 28.5, 16, 12));
  EXPECT_THAT(reasons(capture), ElementsAre(HasSubstr("img1")));
  EXPECT_EQ(capture.frames[0].depth.filename(), "depth0.png");
}

TEST_F(CaptureTest, ReadsReplica) {
  image("results/frame000000.jpg", 60, 34);
  depth("results/depth000000.png", 6553, 60, 34);
  write("traj.txt", "0 -1 0 1 1 0 0 2 0 0 1 3 0 0 0 1\n");
  const Capture capture = read_capture(folder_);
  EXPECT_EQ(capture.layout, "replica");
  ASSERT_EQ(capture.frames.size(), 1u);
  EXPECT_NEAR(norm(capture.frames[0].world_to_camera * Vec3d{1, 2, 5} - Vec3d{0, 0, 2}), 0, 1e-12);
  EXPECT_THAT(capture.frames[0].camera.params, ElementsAre(30, 30, 30, 17));
  EXPECT_NEAR(read_capture_depth(capture, capture.frames[0]).at(3, 3), 1.0, 1e-3);
}

TEST_F(CaptureTest, ReadsTumWithAssociationByTime) {
  image("rgb/10.01.png");
  image("rgb/20.0.png");
  depth("depth/10.0.png", 5000);
  write("rgb.txt", "# color\n10.01 rgb/10.01.png\n20.0 rgb/20.0.png\n");
  write("depth.txt", "10.000 depth/10.0.png\n");
  write("groundtruth.txt", "# t q\n10.005 1 2 3 0 0 0.70710678118 0.70710678118\n10.5 0 0 0 0 0 0 1\n");
  EXPECT_THROW(read_capture(folder_), Error);  // no intrinsics
  write("k.txt", "30 0 16\n0 30 12\n0 0 1\n");
  CaptureOptions options;
  options.intrinsics = folder_ / "k.txt";
  const Capture capture = read_capture(folder_, options);
  EXPECT_EQ(capture.layout, "tum");
  ASSERT_EQ(capture.frames.size(), 1u);
  EXPECT_EQ(capture.frames[0].name, "10_01");
  EXPECT_NEAR(norm(capture.frames[0].world_to_camera * Vec3d{1, 2, 5} - Vec3d{0, 0, 2}), 0, 1e-9);
  EXPECT_NEAR(read_capture_depth(capture, capture.frames[0]).at(3, 3), 1.0, 1e-6);
  EXPECT_THAT(reasons(capture), ElementsAre(HasSubstr("no pose within")));
}

TEST_F(CaptureTest, ReadsTransformsJsonWithOverridesAndDistortion) {
  image("images/a.png");
  image("images/b.png");
  const std::string matrix = "[[0,1,0,1],[1,0,0,2],[0,0,-1,3],[0,0,0,1]]";
  write("transforms.json",
        fmt::format(
            R"({{"fl_x": 30, "fl_y": 31, "cx": 16, "cy": 12, "w": 32, "h": 24, "test_filenames": ["images/b.png"],
          "frames": [{{"file_path": "images/a.png", "transform_matrix": {0}}},
                     {{"file_path": "images/b.png", "fl_x": 40, "k1": 0.1, "transform_matrix": {0}}}]}})",
            matrix));
  const Capture capture = read_capture(folder_);
  EXPECT_EQ(capture.layout, "nerfstudio");
  ASSERT_EQ(capture.frames.size(), 2u);
  EXPECT_EQ(capture.frames[0].camera.model, "PINHOLE");
  EXPECT_EQ(capture.frames[1].camera.model, "OPENCV");
  EXPECT_THAT(capture.frames[1].camera.params, ElementsAre(40, 31, 16, 12, 0.1, 0, 0, 0));
  EXPECT_NEAR(norm(capture.frames[0].world_to_camera * Vec3d{1, 2, 5} - Vec3d{0, 0, 2}), 0, 1e-12);
  EXPECT_THAT(capture.test, ElementsAre("b"));
}

/// A transforms.json of one frame with these further fields.
class TransformsTest : public CaptureTest {
 protected:
  Capture read(const std::string& fields, const std::string& frame_fields = "", const std::string& matrix = kMatrix) {
    if (!fs::exists(folder_ / "images" / "a.png")) image("images/a.png");
    write(
        "transforms.json",
        fmt::format(
            R"({{"fl_x": 30, "fl_y": 31, "cx": 16, "cy": 12{}, "frames": [{{"file_path": "images/a.png", "transform_matrix": {}{}}}]}})",
            fields, matrix, frame_fields));
    return read_capture(folder_);
  }
  std::string error_of(const std::string& fields) {
    try {
      read(fields);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  static constexpr const char* kMatrix = "[[0,1,0,1],[1,0,0,2],[0,0,-1,3],[0,0,0,1]]";
};

TEST_F(TransformsTest, AFisheyeIsOneAlsoWithoutCoefficients) {
  for (const char* fields : {R"(, "camera_model": "OPENCV_FISHEYE")", R"(, "is_fisheye": true)"}) {
    const Capture capture = read(fields);
    EXPECT_EQ(capture.frames[0].camera.model, "THIN_PRISM_FISHEYE") << fields;
  }
  const Capture bent = read(R"(, "camera_model": "OPENCV_FISHEYE", "k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4)");
  EXPECT_THAT(bent.frames[0].camera.params, ElementsAre(30, 31, 16, 12, 0.1, 0.2, 0, 0, 0.3, 0.4, 0, 0));
}

TEST_F(TransformsTest, TheThirdRadialTermOfAPerspectiveLensIsUsed) {
  const Capture capture =
      read(R"(, "camera_model": "OPENCV", "k1": 0.1, "k2": 0.2, "k3": 0.3, "p1": 0.01, "p2": 0.02)");
  EXPECT_EQ(capture.frames[0].camera.model, "FULL_OPENCV");
  EXPECT_THAT(capture.frames[0].camera.params, ElementsAre(30, 31, 16, 12, 0.1, 0.2, 0.01, 0.02, 0.3, 0, 0, 0));
  const Capture list = read(R"(, "distortion_params": [0.1, 0.2, 0, 0, 0.01, 0.02])");
  EXPECT_THAT(list.frames[0].camera.params, ElementsAre(30, 31, 16, 12, 0.1, 0.2, 0.01, 0.02));
}

TEST_F(TransformsTest, LensesThatAreNotUndoneAreRefusedByName) {
  EXPECT_THAT(error_of(R"(, "camera_model": "EQUIRECTANGULAR")"), HasSubstr("EQUIRECTANGULAR"));
  EXPECT_THAT(error_of(R"(, "k4": 0.1)"), HasSubstr("k4"));
  EXPECT_THAT(error_of(R"(, "latlong": true)"), HasSubstr("latlong"));
}

TEST_F(TransformsTest, AnAngleThatContradictsTheFocalLengthIsNamed) {
  EXPECT_THAT(read(R"(, "camera_angle_x": 0.3)").notes,
              ElementsAre(AllOf(HasSubstr("camera_angle_x is not used"), HasSubstr("fl_x says 30"))));
  EXPECT_TRUE(read(R"(, "camera_angle_x": 0.98)").notes.empty());  // 2 atan(16 / 30)
}

TEST_F(TransformsTest, NumbersThatNoLensHasAreRefusedByName) {
  EXPECT_THAT(error_of(R"(, "fl_x": -30)"), HasSubstr("fl_x: a negative focal length"));
  EXPECT_THAT(error_of(R"(, "k1": NaN)"), HasSubstr("k1: expected a finite number"));
  EXPECT_THAT(error_of(R"(, "cx": 64)"), HasSubstr("w and h are absent"));
  EXPECT_THAT(error_of(R"(, "depth_unit_scale_factor": -1)"), HasSubstr("depth_unit_scale_factor"));
  EXPECT_THAT(error_of(R"(, "ply_file_path": "points.ply")"), HasSubstr("ply_file_path: the points are missing"));
  EXPECT_EQ(read(R"(, "cx": 64, "w": 32, "h": 24)").frames.size(), 1u) << "a part of a larger photo";
}

TEST_F(TransformsTest, AnUnknownObjectIsListed) {
  EXPECT_THAT(read(R"(, "lens": {"k1": 0.2})").notes, ElementsAre(HasSubstr("lens")));
}

TEST_F(TransformsTest, ShrunkPhotosStandForMissingOnes) {
  image("images_4/a.png");
  fs::create_directories(folder_ / "images_8");
  write(
      "transforms.json",
      fmt::format(
          R"({{"fl_x": 120, "w": 128, "h": 96, "frames": [{{"file_path": "images/a.png", "transform_matrix": {}}}]}})",
          kMatrix));
  const Capture capture = read_capture(folder_);
  ASSERT_EQ(capture.frames.size(), 1u);
  EXPECT_EQ(capture.frames[0].image, folder_ / "images_4" / "a.png");
  EXPECT_NEAR(capture.frames[0].camera.params[0], 30, 1e-9);
}

TEST_F(TransformsTest, DepthHasTheUnitThatTheFileStates) {
  depth("depth/a.png", 2000);
  const std::string frame = R"(, "depth_path": "depth\\a.png")";
  EXPECT_FLOAT_EQ(read_capture_depth(read("", frame), read("", frame).frames[0]).at(5, 5), 2.0f);
  for (const char* key : {"integer_depth_scale", "depth_unit_scale_factor"}) {
    const Capture capture = read(fmt::format(R"(, "{}": 0.0002)", key), frame);
    EXPECT_FLOAT_EQ(read_capture_depth(capture, capture.frames[0]).at(5, 5), 0.4f) << key;
  }
}

TEST_F(TransformsTest, DepthFilesThatAreMissingAreReported) {
  EXPECT_THAT(read("", R"(, "depth_file_path": "depth/a.png")").notes,
              ElementsAre(HasSubstr("depth_file_path: none of its files is there")));
}

TEST_F(TransformsTest, AnAngleInDegreesIsNamed) {
  EXPECT_THAT(error_of(R"(, "fl_x": 0, "fl_y": 0, "camera_angle_x": 60)"), HasSubstr("radians"));
}

TEST_F(TransformsTest, AUniformScaleOfTheMatrixAppliesToDepth) {
  depth("depth/a.png", 2000);
  const Capture capture =
      read("", R"(, "depth_file_path": "depth/a.png")", "[[0,3,0,1],[3,0,0,2],[0,0,-3,3],[0,0,0,1]]");
  EXPECT_NEAR(norm(capture.frames[0].world_to_camera * Vec3d{1, 2, 5} - Vec3d{0, 0, 2}), 0, 1e-12);
  EXPECT_FLOAT_EQ(read_capture_depth(capture, capture.frames[0]).at(5, 5), 6.0f);
}

TEST_F(TransformsTest, MasksAreFoundAndUnknownParametersListedOnce) {
  image("masks/a.png");
  const Capture capture = read(R"(, "applied_scale": 0.5, "rolling_shutter": [0, 0, 0.1], "tilt_angle": 3)",
                               R"(, "mask_path": "masks/a.png", "gain": 2)");
  EXPECT_EQ(capture.frames[0].mask.filename(), "a.png");
  EXPECT_THAT(capture.notes,
              ElementsAre(HasSubstr("rolling_shutter"), testing::AllOf(HasSubstr("frames.gain, tilt_angle"),
                                                                       testing::Not(HasSubstr("applied_scale")))));
}

TEST_F(TransformsTest, OneBadFrameIsLeftOut) {
  image("images/b.png");
  write(
      "transforms.json",
      fmt::format(
          R"({{"fl_x": 30, "frames": [{{"file_path": "images/a.png", "transform_matrix": {0}}}, {{"file_path": "./images/b", "transform_matrix": {0}}},
          {{"file_path": "images/b.png", "transform_matrix": [[null,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}, {{"file_path": "c.png"}}]}})",
          kMatrix));
  const Capture capture = read_capture(folder_);
  ASSERT_EQ(capture.frames.size(), 1u);
  EXPECT_EQ(capture.frames[0].name, "b");
  EXPECT_THAT(reasons(capture),
              ElementsAre(HasSubstr("a.png: the photo is missing"), HasSubstr("not finite"), HasSubstr("frame needs")));
}

TEST_F(TransformsTest, BlendersFilesAreReadWithTheirSplit) {
  for (const char* name : {"train/r_0.png", "train/r_1.PNG", "test/r_0.png"}) image(name);
  for (const std::string split : {"train", "test"}) {
    std::string frames;
    for (int i = 0; i < (split == "train" ? 2 : 1); ++i)
      frames += fmt::format(R"({}{{"file_path": "./{}/r_{}", "rotation": 0.1, "transform_matrix": {}}})", i ? "," : "",
                            split, i, kMatrix);
    write("transforms_" + split + ".json", fmt::format(R"({{"camera_angle_x": 0.6911112, "frames": [{}]}})", frames));
  }
  const Capture capture = read_capture(folder_);
  ASSERT_EQ(capture.frames.size(), 3u);
  EXPECT_NEAR(capture.frames[0].camera.params[0], 0.5 * kWidth / std::tan(0.5 * 0.6911112), 1e-9);
  EXPECT_THAT(capture.train, ElementsAre("train/r_0", "train/r_1"));
  EXPECT_THAT(capture.test, ElementsAre("test/r_0"));
  EXPECT_TRUE(capture.notes.empty());
}

TEST_F(CaptureTest, PosesAndPhotosPairByNumberWhereOneIsMissing) {
  for (const char* name : {"images/img0.png", "images/img2.png"}) image(name);
  write("focal.txt", "28.5\n");
  write("poses.txt", pose_lost("nan") + pose_lost("nan") + pose_opengl());
  image("images/._img2.png");
  const Capture capture = read_capture(folder_);
  expect_one_known_camera(capture);
  EXPECT_EQ(capture.frames[0].name, "img2");
  EXPECT_THAT(reasons(capture),
              ElementsAre(HasSubstr("._img2.png: a hidden file"), HasSubstr("pose 1: the photo is missing"),
                          ContainsRegex("img0: .*/poses.txt")));
}

TEST_F(CaptureTest, FramesWithoutDepthAreLeftOutWhereMostHaveIt) {
  for (int i = 0; i < 4; ++i) {
    image(fmt::format("images/{}.png", i));
    if (i != 2) depth(fmt::format("depth/{}.png", i), 2000);
    write(fmt::format("poses/{}.txt", i), fmt::format("1 0 0 {}\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", i));
  }
  write("poses/9.txt", pose_opencv());
  write("intrinsics.txt", "30 0 16\n0 31 12\n0 0 1\n");
  const Capture capture = read_capture(folder_);
  EXPECT_EQ(capture.frames.size(), 3u);
  EXPECT_THAT(reasons(capture),
              ElementsAre(HasSubstr("9: the photo is missing"), HasSubstr("2: its depth is missing")));
  fs::remove(folder_ / "depth" / "0.png");
  fs::remove(folder_ / "depth" / "1.png");
  const Capture without = read_capture(folder_);
  EXPECT_EQ(without.frames.size(), 4u);
  EXPECT_THAT(without.notes, ElementsAre(HasSubstr("only 1 of 4 frames have depth")));
}

TEST_F(CaptureTest, IntrinsicsForPhotosOfAnotherSizeAreRefused) {
  image("images/a.png");
  write("poses/a.txt", pose_opencv());
  write("intrinsics.txt", "300 0 160\n0 310 120\n0 0 1\n");
  EXPECT_THROW(read_capture(folder_), Error);
}

TEST_F(CaptureTest, SevenScenesNeedsToBeToldAboutItsColour) {
  image("seq-01/frame-000000.color.png");
  depth("seq-01/frame-000000.depth.png", 1500);
  write("seq-01/frame-000000.pose.txt", pose_opencv());
  EXPECT_THROW(read_capture(folder_), Error);
  CaptureOptions options;
  options.assume_registered = true;
  const Capture capture = read_capture(folder_, options);
  EXPECT_EQ(capture.layout, "7scenes");
  expect_one_known_camera(capture);
  EXPECT_FLOAT_EQ(read_capture_depth(capture, capture.frames[0]).at(3, 3), 1.5f);
}

TEST_F(CaptureTest, ReadsAColmapModelBesideItsImages) {
  image("images/b.jpg");
  write("sparse/0/cameras.txt", "1 SIMPLE_RADIAL 32 24 30 16 12 0.05\n");
  write("sparse/0/images.txt", "7 0.70710678118 0 0 -0.70710678118 -2 1 -3 1 b.jpg\n\n");
  write("sparse/0/points3D.txt", "1 0 0 5 255 0 0 0.5\n");
  const Capture capture = read_capture(folder_);
  EXPECT_EQ(capture.layout, "colmap");
  ASSERT_EQ(capture.frames.size(), 1u);
  EXPECT_NEAR(norm(capture.frames[0].world_to_camera.inverse().translation - Vec3d{1, 2, 3}), 0, 1e-9);
  EXPECT_EQ(capture.cloud.size(), 1u);
}

TEST_F(CaptureTest, AnUnknownFolderSaysWhichLayoutsAreKnown) {
  try {
    read_capture(folder_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_THAT(error.what(), HasSubstr("ScanNet"));
  }
}

TEST_F(CaptureTest, AMatrixThatIsNoRotationIsRefused) {
  image("images/a.jpg");
  write("poses/a.txt", "2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  write("intrinsics.txt", "30 0 16\n0 31 12\n0 0 1\n");
  EXPECT_THROW(read_capture(folder_), Error);
}

TEST_F(CaptureTest, AColumnMajorMatrixIsRefusedByName) {
  image("images/a.jpg");
  write("poses/a.txt", "0 1 0 0\n-1 0 0 0\n0 0 1 0\n1 2 3 1\n");  // pose_opencv() column by column
  write("intrinsics.txt", "30 0 16\n0 31 12\n0 0 1\n");
  try {
    read_capture(folder_);
    ADD_FAILURE() << "read";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("column-major"));
  }
}

TEST_F(CaptureTest, DepthOfEightBitsIsNotUsed) {
  for (const char* name : {"a", "b"}) {
    image(fmt::format("images/{}.jpg", name));
    write(fmt::format("poses/{}.txt", name), pose_opencv());
  }
  write("intrinsics.txt", "30 0 16\n0 31 12\n0 0 1\n");
  fs::create_directories(folder_ / "depth");
  for (const char* name : {"a.png", "b.png"})
    write_png(folder_ / "depth" / name, Image<uint8_t>(kWidth, kHeight, 1, 90));
  const Capture capture = read_capture(folder_);
  EXPECT_THAT(capture.notes, ElementsAre(HasSubstr("8 bits")));
  EXPECT_TRUE(capture.frames[0].depth.empty());
  depth("depth/a.png", 2000);  // among good maps, it is its frame that is bad
  const Capture mixed = read_capture(folder_);
  EXPECT_FLOAT_EQ(read_capture_depth(mixed, mixed.frames[0]).at(5, 5), 2.0f);
  EXPECT_THROW(read_capture_depth(mixed, mixed.frames[1]), Error);
}

TEST_F(CaptureTest, TheFolderBelowThatHoldsAKnownLayoutIsNamed) {
  image("export 1/keyframes/images/a.jpg");
  fs::create_directories(folder_ / "export 1" / "keyframes" / "cameras");
  try {
    read_capture(folder_);
    ADD_FAILURE() << "read";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr((folder_ / "export 1").string()));
    EXPECT_THAT(error.what(), HasSubstr("Polycam"));
  }
}

TEST_F(CaptureTest, TheFolderAroundThatHoldsAKnownLayoutIsNamed) {
  image("images/b.jpg");
  write("sparse/0/cameras.txt", "1 PINHOLE 32 24 30 30 16 12\n");
  write("sparse/0/images.txt", "7 1 0 0 0 0 0 0 1 b.jpg\n\n");
  for (const char* part : {"images", "sparse", "sparse/0"}) {
    try {
      read_capture(folder_ / part);
      ADD_FAILURE() << part;
    } catch (const Error& error) {
      const std::string remedy = error.details().remedy, place = folder_.string();
      EXPECT_THAT(remedy, testing::AnyOf("give " + place + " (COLMAP)",
                                         "give the folder that has the photos as well: " + place))
          << part;
    }
  }
}

TEST_F(CaptureTest, ATextInUtf16IsNamed) {
  write("transforms.json", "\xff\xfe{");
  try {
    read_capture(folder_);
    ADD_FAILURE() << "read";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("UTF-16"));
  }
}

TEST_F(CaptureTest, FormatsThatAreKnownAndNotReadAreNamed) {
  write("EXR_RGBD/metadata.json", R"({"K": [1], "poses": []})");
  image("EXR_RGBD/rgb/0.jpg");
  try {
    read_capture(folder_);
    ADD_FAILURE() << "read";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("Record3D"));
  }
}

TEST_F(CaptureTest, SelectionSpreadsOverTheSceneAndPrefersSharpFrames) {
  // Ten cameras side by side, 1 m apart, looking at a wall; frame 4 is flat grey (no detail), the rest are noisy.
  write("intrinsics.txt", "30 0 16\n0 30 12\n0 0 1\n");
  for (int i = 0; i < 10; ++i) {
    Image<uint8_t> picture(kWidth, kHeight, 3, 90);
    if (i != 4) {
      for (size_t k = 0; k < picture.data.size(); ++k) picture.data[k] = static_cast<uint8_t>((k * 2654435761u) >> 24);
    }
    fs::create_directories(folder_ / "images");
    write_png(folder_ / "images" / fmt::format("{}.png", i), picture);
    depth(fmt::format("depth/{}.png", i), 2000);
    write(fmt::format("poses/{}.txt", i), fmt::format("1 0 0 {}\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", i));
  }
  const Capture capture = read_capture(folder_);
  ThreadPool pool(2);
  ViewSelectionOptions options;
  options.count = 4;
  const std::vector<int> chosen = select_views(capture, options, pool);
  ASSERT_EQ(chosen.size(), 4u);
  EXPECT_LE(chosen.front(), 2);
  EXPECT_GE(chosen.back(), 7);
  EXPECT_THAT(chosen, testing::Not(testing::Contains(4)));
  EXPECT_THAT(select_stride(capture, 4), ElementsAre(0, 4, 8));
  const std::vector<int> test = select_test_views(capture, {0, 5}, 3, pool);
  EXPECT_EQ(test.size(), 3u);
  EXPECT_THAT(test, testing::Each(testing::AnyOf(2, 3, 4, 7, 8, 9)));
  ThreadPool one(1);
  EXPECT_EQ(select_views(capture, options, one), chosen);
}

TEST(NaturalOrder, ComparesRunsOfDigitsAsNumbers) {
  EXPECT_TRUE(natural_less("img2", "img10"));
  EXPECT_TRUE(natural_less("a", "b"));
  EXPECT_TRUE(natural_less("frame", "frame1"));
  EXPECT_FALSE(natural_less("img10", "img9"));
}

}  // namespace
}  // namespace aligngs
