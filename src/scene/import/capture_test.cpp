#include "scene/import/capture.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <functional>

#include "core/error.h"
#include "io/image_file.h"
#include "io/npy.h"
#include "scene/import/capture_text.h"
#include "scene/import/testing/capture_folder.h"
#include "scene/import/view_selection.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;

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

TEST_F(CaptureTest, PosesMayHaveFortransExponents) {
  image("images/a.jpg");
  write("poses/a.txt", "0 -1.0D+00 0 1.d0\n1D0 0 0 2\n0 0 10.0d-1 0.3D1\n0 0 0 1\n");
  write("intrinsics.txt", "3.0D+01 0 16\n0 31 12\n0 0 1\n");
  expect_one_known_camera(read_capture(folder_));
}

TEST_F(CaptureTest, PosesMayBeArraysOfNumpy) {
  image("images/a.jpg");
  fs::create_directories(folder_ / "poses");
  std::vector<float> pose = {0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1};
  write_npy_float32(folder_ / "poses" / "a.npy", {4, 4}, pose.data());
  write("intrinsics.txt", "30 0 16\n0 31 12\n0 0 1\n");
  expect_one_known_camera(read_capture(folder_));
  pose[3] = 4.5e6f;  // of a map: its metres would be rounded
  write_npy_float32(folder_ / "poses" / "a.npy", {4, 4}, pose.data());
  EXPECT_THROW(read_capture(folder_), Error);
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

TEST_F(CaptureTest, ALayoutThatIsAskedForNeedsItsFiles) {
  image("images/b.jpg");
  for (const CaptureLayout& layout : capture_layouts()) {
    try {
      read_capture(folder_, {.layout = layout.name});
      ADD_FAILURE() << layout.name;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::string("this has not the files of ") + layout.title));
      EXPECT_THAT(error.details().remedy, HasSubstr(layout.files));
    }
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
