// Names of frames in encodings and spellings of other systems.
#include <gmock/gmock.h>

#include "io/text_encoding.h"
#include "scene/import/capture_frames.h"
#include "scene/import/testing/capture_folder.h"

namespace aligngs {
namespace {

using testing::ElementsAre;

constexpr const char* kLatin1 = "B\xe4r0";
constexpr const char* kUtf8 = "B\xc3\xa4r0";
constexpr const char* kDecomposed = "Ba\xcc\x88r0";

std::vector<std::string> names(const Capture& capture) {
  std::vector<std::string> all;
  for (const CapturedFrame& frame : capture.frames) all.push_back(frame.name);
  return all;
}

TEST_F(CaptureTest, APhotoOfAKindThatIsNotReadIsNamed) {
  image("images/b.png");
  write("images/a.tif", "II*");
  write("sparse/cameras.txt", "1 PINHOLE 32 24 30 30 16 12\n");
  write("sparse/images.txt", "1 1 0 0 0 0 0 0 1 a.png\n\n2 1 0 0 0 1 0 0 1 b.png\n\n");
  EXPECT_THAT(reasons(read_capture(folder_)),
              testing::ElementsAre("a.png: a.tif is of a kind that is not read: convert it to PNG or JPEG"));
}

TEST_F(CaptureTest, NamesOfScanNetAreUtf8) {
  const std::string matrix = "30 0 16 0\n0 30 12 0\n0 0 1 0\n0 0 0 1\n";
  write("intrinsic/intrinsic_color.txt", matrix);
  image(std::string("color/") + kLatin1 + ".png");
  depth(std::string("depth/") + kLatin1 + ".png", 2000);
  write(std::string("pose/") + kLatin1 + ".txt", pose_opencv());
  const Capture capture = read_capture(folder_);
  EXPECT_THAT(names(capture), ElementsAre(kUtf8));
  EXPECT_FALSE(capture.frames[0].depth.empty());
}

TEST_F(CaptureTest, NamesOfPolycamAreUtf8) {
  image(std::string("keyframes/images/") + kLatin1 + ".png");
  depth(std::string("keyframes/depth/") + kLatin1 + ".png", 2000);
  write(std::string("keyframes/cameras/") + kLatin1 + ".json",
        R"({"fx": 30, "fy": 30, "cx": 16, "cy": 12, "width": 32, "height": 24, "t_00": 1, "t_01": 0, "t_02": 0,
            "t_03": 0, "t_10": 0, "t_11": 1, "t_12": 0, "t_13": 0, "t_20": 0, "t_21": 0, "t_22": 1, "t_23": 0})");
  const Capture capture = read_capture(folder_);
  EXPECT_THAT(names(capture), ElementsAre(kUtf8));
  EXPECT_FALSE(capture.frames[0].depth.empty());
}

TEST_F(CaptureTest, NamesOfTumAreUtf8) {
  image(std::string("rgb/") + kLatin1 + ".png");
  write("rgb.txt", std::string("1.0 rgb/") + kLatin1 + ".png\n");
  write("groundtruth.txt", "1.0 0 0 0 0 0 0 1\n");
  write("k.txt", "30 0 16\n0 30 12\n0 0 1\n");
  CaptureOptions options;
  options.intrinsics = folder_ / "k.txt";
  EXPECT_THAT(names(read_capture(folder_, options)), ElementsAre(kUtf8));
}

std::vector<CapturedFrame> frames_of(std::initializer_list<const char*> names) {
  std::vector<CapturedFrame> frames;
  for (const char* name : names) frames.emplace_back().name = name;
  return frames;
}

TEST(FrameNames, ListsOfMacOsMeanTheSameLetters) {
  EXPECT_EQ(FrameNames(frames_of({"a", kUtf8})).find(kDecomposed), 1);
  EXPECT_EQ(FrameNames(frames_of({kDecomposed, "a"})).find(std::string("images/") + kUtf8 + ".png"), -1);
  EXPECT_EQ(FrameNames(frames_of({kDecomposed, "a"})).find(std::string(kUtf8) + ".png"), 0);
}

TEST(FrameNames, ListsMayWriteNamesAsWebAddressesDo) {
  EXPECT_EQ(FrameNames(frames_of({"a", "my photo"})).find("images/my%20photo.png"), 1);
  EXPECT_EQ(FrameNames(frames_of({"my photo", "my%20photo"})).find("my%20photo.png"), 1);
}

TEST(FrameNames, TwoFramesInOtherSpellingsAreNoAnswer) {
  EXPECT_EQ(FrameNames(frames_of({"img", "IMG"})).find("Img"), -1);
  EXPECT_EQ(FrameNames(frames_of({"img", "IMG"})).find("IMG"), 1);
}

}  // namespace
}  // namespace aligngs
