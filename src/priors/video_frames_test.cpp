#include "priors/video_frames.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "core/error.h"
#include "io/image_file.h"
#include "io/picture_format.h"
#include "priors/child_process.h"
#include "priors/photo_folder.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class VideoFrames : public testing::Test {
 protected:
  void SetUp() override {
    if (find_program("ffmpeg").empty()) GTEST_SKIP() << "needs the program ffmpeg";
    folder = fs::path(testing::TempDir()) /
             ("video_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  /// So many frames, 30 a second.
  fs::path short_video(int frames) const {
    const fs::path file = folder / ("short" + std::to_string(frames) + ".mp4");
    EXPECT_EQ(run_child({"ffmpeg", "-nostdin", "-v", "error", "-f", "lavfi", "-i", "testsrc2=size=160x120:rate=30",
                         "-frames:v", std::to_string(frames), "-c:v", "mpeg4", "-q:v", "3", file.string()},
                        folder / "make.log")
                  .status,
              0);
    return file;
  }
  VideoFramesReport take(const fs::path& file, int views) const {
    return take_video_frames(file, folder / "frames", {.views = views, .progress = {.enabled = false}});
  }
  /// Three seconds of a moving test picture of 160 x 120, 10 frames a second.
  fs::path video(const std::vector<std::string>& options = {}) const {
    const fs::path file = folder / "clip.mp4";
    std::vector<std::string> arguments = {"ffmpeg", "-nostdin", "-v",   "error",
                                          "-f",     "lavfi",    "-i",   "testsrc2=size=160x120:rate=10:duration=3",
                                          "-c:v",   "mpeg4",    "-q:v", "3"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    arguments.push_back(file.string());
    EXPECT_EQ(run_child(arguments, folder / "make.log").status, 0);
    return file;
  }
  std::string error_of(const fs::path& file) const {
    try {
      take_video_frames(file, folder / "frames", {});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  fs::path folder;
};

TEST_F(VideoFrames, TakesAsManyAsWanted) {
  const VideoFramesReport report =
      take_video_frames(video(), folder / "frames", {.views = 5, .progress = {.enabled = false}});
  EXPECT_EQ(report.frames, 5u);
  EXPECT_EQ(report.looked_at, 30u);
  EXPECT_NEAR(report.seconds, 3, 0.1);
  EXPECT_LT(report.exposure_walk, 1.2);
  const PhotoList photos = list_photos(folder / "frames");
  ASSERT_EQ(photos.photos.size(), 5u);
  EXPECT_EQ(photos.photos[0].width, 160);
  EXPECT_EQ(photos.photos[0].name, "frame_00001");
}

TEST_F(VideoFrames, ATelephoneHeldUprightGivesUprightFrames) {
  const fs::path file = folder / "turned.mp4";
  ASSERT_EQ(run_child({"ffmpeg", "-nostdin", "-v", "error", "-i", video().string(), "-c", "copy", "-metadata:s:v:0",
                       "rotate=90", file.string()},
                      folder / "make.log")
                .status,
            0);
  take_video_frames(file, folder / "frames", {.views = 3, .progress = {.enabled = false}});
  const ImageInfo info = read_image_info(folder / "frames" / "frame_00001.jpg");
  EXPECT_EQ(info.width, 120);
  EXPECT_EQ(info.height, 160);
}

TEST_F(VideoFrames, AnAutomaticExposureIsReported) {
  const fs::path file = video({"-vf", "eq=brightness='0.3*sin(t*2)':eval=frame"});
  EXPECT_GT(take_video_frames(file, folder / "frames", {.views = 8, .progress = {.enabled = false}}).exposure_walk,
            1.3);
}

TEST_F(VideoFrames, AFileThatIsNoVideoIsNamed) {
  std::ofstream(folder / "clip.mp4") << "no video";
  EXPECT_THAT(error_of(folder / "clip.mp4"),
              testing::AllOf(testing::HasSubstr("clip.mp4"), testing::HasSubstr("ffprobe cannot read it"),
                             testing::HasSubstr("Invalid data")));
}

TEST_F(VideoFrames, AMissingFileIsNamed) {
  EXPECT_THAT(error_of(folder / "absent.mp4"), testing::HasSubstr("no such file"));
}

TEST_F(VideoFrames, AMissingFfmpegIsNamedWithItsPackage) {
  const fs::path file = video();
  const std::string path = std::getenv("PATH");
  setenv("PATH", folder.c_str(), 1);
  const std::string error = error_of(file);
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(error, testing::HasSubstr("apt-get install ffmpeg"));
}

TEST(VideoName, IsToldByItsExtension) {
  EXPECT_TRUE(is_video_name("a/IMG_1.MOV"));
  EXPECT_FALSE(is_video_name("a/IMG_1.jpg"));
  EXPECT_FALSE(is_video_name("mp4"));
}

TEST_F(VideoFrames, AClipWithFewerFramesThanWantedGivesAll) {
  for (const int frames : {2, 3, 7}) {
    fs::remove_all(folder / "frames");
    EXPECT_EQ(take(short_video(frames), 40).frames, size_t(frames));
    EXPECT_TRUE(fs::exists(folder / "frames" / fmt::format("frame_{:05d}.jpg", frames)));
  }
}

TEST_F(VideoFrames, FramesOfTheVideoAreCountedBeforeTheyAreThinned) {
  const VideoFramesReport report = take(short_video(90), 4);
  EXPECT_EQ(report.in_video, 90u);
  EXPECT_NEAR(double(report.looked_at), 32, 1);
}

TEST_F(VideoFrames, ASingleFrameIsCountedInTheError) {
  EXPECT_THAT(error_of(short_video(1)), testing::HasSubstr("it has 1 frame, and two are needed"));
}

}  // namespace
}  // namespace aligngs
