#include <gmock/gmock.h>

#include <fstream>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/import/capture.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

class PhoneReader : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("phone_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void write(const fs::path& file, const std::string& text) const {
    fs::create_directories((folder / file).parent_path());
    std::ofstream(folder / file) << text;
  }
  /// A camera at (1, 2, 3) that looks along -z of the world, as ARKit's does at the start.
  void polycam_frame(const std::string& name, const std::string& t_12 = "\"t_12\": 0,") const {
    write("keyframes/cameras/" + name + ".json",
          R"({"fx": 30, "fy": 30, "cx": 20, "cy": 15, "width": 40, "height": 30,
      "t_00": 1, "t_01": 0, "t_02": 0, "t_03": 1, "t_10": 0, "t_11": 1, )" +
              t_12 + R"("t_13": 2, "t_20": 0, "t_21": 0, "t_22": 1, "t_23": 3})");
    fs::create_directories(folder / "keyframes/images");
    write_jpeg(folder / "keyframes/images" / (name + ".jpg"), Image<uint8_t>(40, 30, 3, 90));
  }
  /// The same camera in 3D Scanner App's files; `first`: the first entry of its matrix.
  void scanner_frame(const std::string& number, const std::string& first = "1") const {
    write_jpeg(folder / ("frame_" + number + ".jpg"), Image<uint8_t>(40, 30, 3, 90));
    write("frame_" + number + ".json", R"({"intrinsics": [30, 0, 20, 0, 30, 15, 0, 0, 1], "cameraPoseARFrame": [)" +
                                           first + ", 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]}");
  }
  fs::path folder;
};

TEST_F(PhoneReader, PolycamIsRecognisedAndStandsUpright) {
  polycam_frame("100");
  const Capture capture = read_capture(folder);
  EXPECT_EQ(capture.layout, "polycam");
  EXPECT_TRUE(capture.metric);
  EXPECT_EQ(capture.up->y, 1);
  ASSERT_EQ(capture.frames.size(), 1u);
  const Vec3d ahead = capture.frames[0].world_to_camera * Vec3d{1, 2, 1};  // two metres in front
  EXPECT_NEAR(ahead.z, 2, 1e-9);
  const Vec3d above = capture.frames[0].world_to_camera * Vec3d{1, 3, 1};
  EXPECT_NEAR(above.y, -1, 1e-9);  // image rows go down
}

TEST_F(PhoneReader, WithoutCorrectedCamerasAWarningTellsIt) {
  polycam_frame("100");
  EXPECT_THAT(read_capture(folder).notes, Contains(HasSubstr("no corrected cameras")));
}

TEST_F(PhoneReader, DepthOfTheLowestConfidenceIsNone) {
  polycam_frame("100");
  Image<uint16_t> depth(40, 30, 1, 1500);
  Image<uint8_t> confidence(40, 30, 1, 255);
  confidence.at(0, 0) = 0;
  confidence.at(1, 0) = 54;  // medium
  fs::create_directories(folder / "keyframes/depth");
  fs::create_directories(folder / "keyframes/confidence");
  write_png16(folder / "keyframes/depth/100.png", depth);
  write_png(folder / "keyframes/confidence/100.png", confidence);
  const Capture capture = read_capture(folder);
  const ImageF read = read_capture_depth(capture, capture.frames[0]);
  EXPECT_EQ(read.at(0, 0), 0);
  EXPECT_FLOAT_EQ(read.at(1, 0), 1.5f);
}

TEST_F(PhoneReader, ConfidenceOfAnotherSizeIsRefused) {
  polycam_frame("100");
  for (const char* maps : {"depth", "confidence"}) fs::create_directories(folder / "keyframes" / maps);
  write_png16(folder / "keyframes/depth/100.png", Image<uint16_t>(40, 30, 1, 1500));
  write_png(folder / "keyframes/confidence/100.png", Image<uint8_t>(20, 15, 1, 255));
  const Capture capture = read_capture(folder);
  EXPECT_THROW(read_capture_depth(capture, capture.frames[0]), Error);
}

TEST_F(PhoneReader, APhotoWithoutItsCameraIsLeftOut) {
  polycam_frame("100");
  polycam_frame("200");
  fs::remove(folder / "keyframes/cameras/200.json");
  const Capture capture = read_capture(folder);
  EXPECT_EQ(capture.frames.size(), 1u);
  ASSERT_EQ(capture.left_out.size(), 1u);
  EXPECT_THAT(capture.left_out[0].reason, HasSubstr("camera is missing"));
}

TEST_F(PhoneReader, ScannerAppIsRecognisedByItsJson) {
  write_jpeg(folder / "frame_00000.jpg", Image<uint8_t>(40, 30, 3, 90));
  write(
      "frame_00000.json",
      R"({"intrinsics": [30, 0, 20, 0, 30, 15, 0, 0, 1], "cameraPoseARFrame": [1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]})");
  write(
      "frame_00001.json",
      R"({"intrinsics": [30, 0, 20, 0, 30, 15, 0, 0, 1], "cameraPoseARFrame": [1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]})");
  const Capture capture = read_capture(folder);
  EXPECT_EQ(capture.layout, "3dscanner");
  EXPECT_EQ(capture.frames.size(), 1u);
  EXPECT_TRUE(capture.left_out.empty());
  EXPECT_NEAR(capture.frames[0].world_to_camera.inverse().translation.z, 3, 1e-9);
}

TEST_F(PhoneReader, ALostPoseIsNamed) {
  write_jpeg(folder / "frame_00000.jpg", Image<uint8_t>(40, 30, 3, 90));
  write_jpeg(folder / "frame_00001.jpg", Image<uint8_t>(40, 30, 3, 90));
  write(
      "frame_00000.json",
      R"({"intrinsics": [30, 0, 20, 0, 30, 15, 0, 0, 1], "cameraPoseARFrame": [1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]})");
  write(
      "frame_00001.json",
      R"({"intrinsics": [30, 0, 20, 0, 30, 15, 0, 0, 1], "cameraPoseARFrame": [NaN, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]})");
  const Capture capture = read_capture(folder);
  EXPECT_EQ(capture.frames.size(), 1u);
  ASSERT_EQ(capture.left_out.size(), 1u);
  EXPECT_THAT(capture.left_out[0].reason, HasSubstr("lost tracking"));
}

TEST_F(PhoneReader, AFieldOfAPolycamCameraThatIsMissingIsNamed) {
  polycam_frame("100");
  polycam_frame("200", "");
  const Capture capture = read_capture(folder);
  EXPECT_EQ(capture.frames.size(), 1u);
  ASSERT_EQ(capture.left_out.size(), 1u);
  EXPECT_THAT(capture.left_out[0].reason, HasSubstr("t_12: the field is missing"));
}

TEST_F(PhoneReader, AFieldOfAPolycamCameraThatIsNoNumberIsNamed) {
  for (const char* value : {"\"abc\"", "\"0\"", "null"}) {
    polycam_frame("100");
    polycam_frame("200", std::string("\"t_12\": ") + value + ",");
    const Capture capture = read_capture(folder);
    ASSERT_EQ(capture.left_out.size(), 1u) << value;
    EXPECT_THAT(capture.left_out[0].reason, HasSubstr(std::string("t_12: expected a number, found ") + value));
  }
}

TEST_F(PhoneReader, APolycamPoseOfNaNIsLostTracking) {
  polycam_frame("100");
  polycam_frame("200", "\"t_12\": NaN,");
  const Capture capture = read_capture(folder);
  ASSERT_EQ(capture.left_out.size(), 1u);
  EXPECT_THAT(capture.left_out[0].reason, HasSubstr("lost tracking"));
}

TEST_F(PhoneReader, AnEntryOfAScannerPoseThatIsNoNumberIsNamed) {
  scanner_frame("00000", "1");
  scanner_frame("00001", "\"abc\"");
  const Capture capture = read_capture(folder);
  EXPECT_EQ(capture.frames.size(), 1u);
  ASSERT_EQ(capture.left_out.size(), 1u);
  EXPECT_THAT(capture.left_out[0].reason, HasSubstr("cameraPoseARFrame[0]: expected a number, found \"abc\""));
}

TEST_F(PhoneReader, PolycamCamerasWithoutTheirPhotoAreListed) {
  polycam_frame("100");
  polycam_frame("200");
  fs::remove(folder / "keyframes/images/200.jpg");
  const Capture capture = read_capture(folder);
  EXPECT_EQ(capture.frames.size(), 1u);
  ASSERT_EQ(capture.left_out.size(), 1u);
  EXPECT_EQ(capture.left_out[0].name, "200");
  EXPECT_EQ(capture.left_out[0].reason, "the photo is missing");
}

TEST_F(PhoneReader, FramesWithoutConfidenceAreCountedWhereOthersHaveOne) {
  for (const char* number : {"00000", "00001", "00002"}) {
    scanner_frame(number);
    write_png16(folder / (std::string("depth_") + number + ".png"), Image<uint16_t>(40, 30, 1, 1500));
  }
  write_png(folder / "conf_00001.png", Image<uint8_t>(40, 30, 1, 2));
  EXPECT_THAT(read_capture(folder).notes,
              testing::ElementsAre(HasSubstr("2 of 3 frames with depth have no confidence")));
}

TEST_F(PhoneReader, PolycamFramesWithoutConfidenceAreCounted) {
  for (const char* maps : {"depth", "confidence"}) fs::create_directories(folder / "keyframes" / maps);
  for (const char* name : {"100", "200"}) {
    polycam_frame(name);
    write_png16(folder / "keyframes" / "depth" / (std::string(name) + ".png"), Image<uint16_t>(40, 30, 1, 1500));
  }
  write_png(folder / "keyframes" / "confidence" / "100.png", Image<uint8_t>(40, 30, 1, 255));
  EXPECT_THAT(read_capture(folder).notes, Contains(HasSubstr("1 of 2 frames with depth have no confidence, and all of "
                                                             "their depth is used: 200")));
}

TEST_F(PhoneReader, ACaptureWithoutAnyConfidenceGivesNoLine) {
  for (const char* number : {"00000", "00001"}) {
    scanner_frame(number);
    write_png16(folder / (std::string("depth_") + number + ".png"), Image<uint16_t>(40, 30, 1, 1500));
  }
  EXPECT_THAT(read_capture(folder).notes, testing::IsEmpty());
}

TEST_F(PhoneReader, AConfidenceThatTrustsNothingIsNamed) {
  polycam_frame("100");
  fs::create_directories(folder / "keyframes/depth");
  fs::create_directories(folder / "keyframes/confidence");
  write_png16(folder / "keyframes/depth/100.png", Image<uint16_t>(40, 30, 1, 1500));
  write_png(folder / "keyframes/confidence/100.png", Image<uint8_t>(40, 30, 1, 0));
  const Capture capture = read_capture(folder);
  try {
    read_capture_depth(capture, capture.frames[0]);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.details().path.parent_path().filename(), "confidence");
    EXPECT_THAT(error.what(), HasSubstr("no pixel has a confidence above 0"));
  }
}

}  // namespace
}  // namespace aligngs
