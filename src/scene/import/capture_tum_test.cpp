// TUM RGB-D folders as other programs and systems leave them.
#include <gmock/gmock.h>

#include <tuple>

#include "core/error.h"
#include "scene/import/testing/capture_folder.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Two frames, the second a metre to the right of the first.
class TumTest : public CaptureTest {
 protected:
  static constexpr const char* kPoses = "1.00 0 0 0 0 0 0 1\n2.00 1 0 0 0 0 0 1\n";

  Capture read(const std::string& colors, const std::string& poses = kPoses) {
    write("rgb.txt", colors);
    write("groundtruth.txt", poses);
    write("k.txt", "30 0 16\n0 30 12\n0 0 1\n");
    CaptureOptions options;
    options.intrinsics = folder_ / "k.txt";
    return read_capture(folder_, options);
  }
  static std::vector<double> places(const Capture& capture) {
    std::vector<double> x;
    for (const CapturedFrame& frame : capture.frames) x.push_back(frame.world_to_camera.inverse().translation.x);
    return x;
  }
};

TEST_F(TumTest, BlankLinesAndLineEndsOfWindowsAreNoData) {
  image("rgb/a.png");
  image("rgb/b.png");
  EXPECT_THAT(places(read("# color\r\n\r\n1.0 rgb/a.png\r\n  \r\n2.0 rgb/b.png\r\n\r\n")), ElementsAre(0, 1));
}

TEST_F(TumTest, IntrinsicsCountFromTheCentreOfTheFirstPixel) {
  image("rgb/a.png");
  EXPECT_THAT(read("1.0 rgb/a.png\n").frames[0].camera.params, ElementsAre(30, 30, 16.5, 12.5));
}

TEST_F(TumTest, BackslashesAreSlashes) {
  image("rgb/a.png");
  image("rgb/b.png");
  depth("depth/a.png", 5000);
  depth("depth/b.png", 5000);
  write("depth.txt", "1.0 depth\\a.png\n2.0 depth\\b.png\n");
  const Capture capture = read("1.0 rgb\\a.png\n2.0 rgb\\b.png\n");
  EXPECT_THAT(places(capture), ElementsAre(0, 1));
  EXPECT_EQ(capture.frames[0].name, "a");
  EXPECT_EQ(capture.frames[1].depth, folder_ / "depth" / "b.png");
}

TEST_F(TumTest, AnotherExtensionIsFound) {
  image("rgb/a.PNG");
  image("rgb/b.jpg");
  EXPECT_THAT(places(read("1.0 rgb/a.png\n2.0 rgb/b.png\n")), ElementsAre(0, 1));
}

TEST_F(TumTest, AMissingPhotoLeavesItsFrameOut) {
  image("rgb/a.png");
  EXPECT_THAT(reasons(read("1.0 rgb/a.png\n2.0 rgb/b.png\n")), ElementsAre("b: the photo is missing"));
}

TEST_F(TumTest, PosesNeedNoOrder) {
  image("rgb/a.png");
  image("rgb/b.png");
  const std::string poses = "2.01 9 0 0 0 0 0 1\n2.00 1 0 0 0 0 0 1\n1.00 0 0 0 0 0 0 1\n0.99 8 0 0 0 0 0 1\n";
  EXPECT_THAT(places(read("1.001 rgb/a.png\n1.999 rgb/b.png\n", poses)), ElementsAre(0, 1));
}

TEST_F(TumTest, OfTwoPosesOfOneMomentTheFirstCounts) {
  image("rgb/a.png");
  EXPECT_THAT(places(read("1.0 rgb/a.png\n", "1.0 0 0 0 0 0 0 1\n1.0 5 0 0 0 0 0 1\n")), ElementsAre(0));
  EXPECT_THAT(places(read("1.005 rgb/a.png\n", "1.0 0 0 0 0 0 0 1\n1.0 5 0 0 0 0 0 1\n")), ElementsAre(0));
}

TEST_F(TumTest, ZeroBytesAreNamed) {
  image("rgb/a.png");
  try {
    read(std::string("1.0 rgb/a.png\n\0\0\0", 17));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("rgb.txt: this text holds zero bytes"));
  }
}

TEST_F(TumTest, CommasBetweenTheNumbersOfAPoseAreBlanks) {
  image("rgb/a.png");
  image("rgb/b.png");
  EXPECT_THAT(places(read("1.0 rgb/a.png\n2.0 rgb/b.png\n", "1.0,0,0,0,0,0,0,1\n2.0, 1, 0, 0, 0, 0, 0, 1\n")),
              ElementsAre(0, 1));
}

TEST_F(TumTest, TablesOfSpreadsheetsHaveAHeaderAndCommas) {
  image("rgb/a.png");
  image("rgb/b.png");
  EXPECT_THAT(places(read("1.0 rgb/a.png\n2.0 rgb/b.png\n",
                          "timestamp,tx,ty,tz,qx,qy,qz,qw\n1.0,0,0,0,0,0,0,1\n2.0,1,0,0,0,0,0,1\n")),
              ElementsAre(0, 1));
}

TEST_F(TumTest, ACameraBeyondAllOthersIsLeftOut) {
  std::string colors, poses;
  for (int i = 1; i <= 5; ++i) {
    image(fmt::format("rgb/{}.png", i));
    colors += fmt::format("{0}.0 rgb/{0}.png\n", i);
    poses += fmt::format("{}.0 {} 0 0 0 0 0 1\n", i, i == 4 ? 3e6 : i);
  }
  const Capture capture = read(colors, poses);
  EXPECT_THAT(places(capture), ElementsAre(1, 2, 3, 5));
  ASSERT_EQ(capture.left_out.size(), 1u);
  EXPECT_THAT(capture.left_out[0].reason, HasSubstr("beyond all others"));
}

TEST_F(TumTest, TimesOfAnotherClockOrUnitAreNamed) {
  image("rgb/a.png");
  try {
    read("1.5 rgb/a.png\n", "1000000000 0 0 0 0 0 0 1\n2000000000 1 0 0 0 0 0 1\n");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("the poses are of 1000000000 to 2000000000, the photos of 1.5 to 1.5"));
  }
}

TEST_F(TumTest, EmptyListsAreNamed) {
  image("rgb/a.png");
  for (const auto& [colors, poses, message] :
       {std::tuple{"1.0 rgb/a.png\n", "# nothing\n", "groundtruth.txt"}, {"\n", kPoses, "rgb.txt"}}) {
    try {
      read(colors, poses);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(message));
    }
  }
}

}  // namespace
}  // namespace aligngs
