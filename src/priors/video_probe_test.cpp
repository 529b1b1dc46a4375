#include "priors/video_probe.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr const char* kUpright =
    R"({"streams": [{"width": 1920, "height": 1080, "avg_frame_rate": "30000/1001", "duration": "12.5",
        "side_data_list": [{"rotation": -90}], "tags": {"rotate": "90"}}], "format": {"duration": "13"}})";

bool refused(const std::string& text) {
  try {
    parse_video_probe(text, "film.mp4");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().path, "film.mp4");
    return true;
  }
  return false;
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = kUpright;
  return text.replace(text.find(from), from.size(), to);
}

TEST(VideoProbe, AQuarterTurnIsUndone) {
  const VideoStream stream = parse_video_probe(kUpright, "film.mp4");
  EXPECT_EQ(stream.width, 1080);
  EXPECT_EQ(stream.height, 1920);
  EXPECT_EQ(stream.seconds, 12.5);
  EXPECT_NEAR(stream.frame_rate, 29.97, 0.001);
}

TEST(VideoProbe, TheLengthOfTheFileStandsInForTheStreams) {
  EXPECT_EQ(parse_video_probe(with(R"("duration": "12.5")", R"("duration": "N/A")"), "film.mp4").seconds, 13);
}

TEST(VideoProbe, FieldsOfOtherTypesAreRefusedOrLeftOut) {
  EXPECT_TRUE(refused(with("1920", "\"wide\"")));
  EXPECT_TRUE(refused(with("1920", "1e300")));
  EXPECT_TRUE(refused(with("\"30000/1001\"", "30")));
  EXPECT_TRUE(refused(with("\"30000/1001\"", "\"0/0\"")));
  EXPECT_TRUE(refused(R"({"streams": 7})"));
  EXPECT_TRUE(refused(R"({"streams": ["x"]})"));
  EXPECT_TRUE(refused("{\"streams\": ["));
  EXPECT_FALSE(refused(with("{\"rotate\": \"90\"}", "[]")));
  EXPECT_FALSE(refused(with("[{\"rotation\": -90}]", "{\"rotation\": {}}")));
  EXPECT_FALSE(refused(with("\"90\"", "90")));
}

TEST(VideoProbe, EveryCutIsRefused) {
  const std::string text = kUpright;
  for (size_t keep = 0; keep < text.size(); ++keep) EXPECT_TRUE(refused(text.substr(0, keep))) << keep;
}

TEST(VideoProbe, TheFileCountsItsFrames) {
  EXPECT_EQ(
      parse_video_probe(with(R"("duration": "12.5")", R"("duration": "12.5", "nb_frames": "374")"), "film.mp4").frames,
      374);
}

TEST(VideoProbe, AFileThatCountsNoFramesHasThemByLengthAndRate) {
  EXPECT_NEAR(parse_video_probe(kUpright, "film.mp4").frames, 374.6, 0.1);
}

}  // namespace
}  // namespace aligngs
