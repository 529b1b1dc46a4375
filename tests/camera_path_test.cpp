// `aligngs render --path` and `--view` as a user meets them, on a run trained for a moment.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "cli/stages/video_writer.h"
#include "io/atomic_file.h"
#include "io/drawn_picture.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "support/process.h"
#include "support/small_scene.h"
#include "support/started_process.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;
using testing_support::StartedProcess;
using testing_support::wait_until;

constexpr double kPatienceToRender = 60;  // seconds
constexpr const char* kKeys = R"({"format": "aligngs camera path", "version": 1, "keys": [
  {"time": 0, "eye": [0, 0, 0], "target": [1, 0.1, 0.1]}, {"time": 2, "eye": [0.3, 0.1, 0], "target": [1, 0.5, 0.1], "fov": 50}]})";

class CameraPathCommand : public testing::Test {
 protected:
  static fs::path root() { return fs::path(testing::TempDir()) / "camera_path_command"; }
  static std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }
  static ProcessResult aligngs(const std::string& arguments) { return run_aligngs(arguments, root() / "scratch"); }

  static void SetUpTestSuite() {
    fs::remove_all(root());
    testing_support::write_small_scene(root() / "scene");
    const ProcessResult trained =
        aligngs("train " + quoted(root() / "scene") + " -o " + quoted(root() / "run") + " -n 40 -q");
    ASSERT_EQ(trained.status, 0) << trained.err;
    write_file_atomically(root() / "keys.json", kKeys);
  }
  void SetUp() override {
    fs::remove_all(root() / "out");
    fs::create_directories(root() / "out");
  }
  static ProcessResult render(const std::string& arguments) {
    return aligngs("render " + quoted(root() / "run") + " -q --size 64x48 " + arguments);
  }
  static size_t files(const fs::path& folder) {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }
};

TEST_F(CameraPathCommand, PicturesOfKeyFramesAreCountedByTimeAndRate) {
  const ProcessResult made =
      render("--path " + quoted(root() / "keys.json") + " --fps 5 --json -o " + quoted(root() / "out" / "frames"));
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(parse_json(made.out)["pictures"], 11);
  EXPECT_EQ(files(root() / "out" / "frames"), 11u);
  const Image<uint8_t> first = read_image(root() / "out" / "frames" / "frame_00001.png"),
                       last = read_image(root() / "out" / "frames" / "frame_00011.png");
  EXPECT_EQ(first.width, 64);
  EXPECT_EQ(first.height, 48);
  EXPECT_NE(first.data, last.data);
}

TEST_F(CameraPathCommand, ToursGiveAVideoOrWithoutFfmpegItsPictures) {
  const fs::path video = root() / "out" / "orbit.mp4";
  const ProcessResult made = render("--path orbit --seconds 1 --fps 4 --json -o " + quoted(video));
  ASSERT_EQ(made.status, 0) << made.err;
  if (parse_json(made.out)["video_missing"] == false) {
    EXPECT_EQ(read_file(video).substr(4, 4), "ftyp");
  } else {
    EXPECT_EQ(files(root() / "out" / "orbit"), 5u);
  }
  const char* path = std::getenv("PATH");
  const std::string kept = path != nullptr ? path : "";
  setenv("PATH", "/nowhere", 1);
  const ProcessResult bare =
      run_aligngs("render " + quoted(root() / "run") + " --size 64x48 --path walk --seconds 1 --fps 4 -o " +
                      quoted(root() / "out" / "walk.mp4"),
                  root() / "scratch");
  setenv("PATH", kept.c_str(), 1);
  ASSERT_EQ(bare.status, 0) << bare.err;
  EXPECT_THAT(bare.err, HasSubstr("ffmpeg is not installed"));
  EXPECT_EQ(files(root() / "out" / "walk"), 5u);
  EXPECT_FALSE(fs::exists(root() / "out" / "walk.mp4"));
}

/// A video that cannot be written whole, here for a limit of file sizes, as on a full disk. Without -xerror ffmpeg ends
/// with status 0 then.
TEST_F(CameraPathCommand, AVideoThatIsCutIsAnError) {
  if (!can_write_video()) GTEST_SKIP() << "needs the program ffmpeg";
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{1024, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const ProcessResult cut = render("--path orbit --seconds 2 --fps 8 -q -o " + quoted(root() / "out" / "cut.mp4"));
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_NE(cut.status, 0);
  EXPECT_EQ(files(root() / "out"), 0u) << cut.err;
}

TEST_F(CameraPathCommand, OnePictureOfAWayOrOfAPhoto) {
  const std::string file = quoted(root() / "out" / "a.png");
  ASSERT_EQ(render("--path " + quoted(root() / "keys.json") + " --at 1 -o " + file).status, 0);
  EXPECT_EQ(read_image(root() / "out" / "a.png").width, 64);
  const std::string view = parse_json(read_file(root() / "run" / "cameras.json"))[0]["img_name"];
  ASSERT_EQ(render("--view " + view + " -o " + file).status, 0);
  const ProcessResult unknown = render("--view " + view + "x -o " + file);
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean " + view));
}

TEST_F(CameraPathCommand, RefusesWhatMakesNoSenseAndWritesNothing) {
  const std::string out = " -o " + quoted(root() / "out" / "x.mp4"), keys = "--path " + quoted(root() / "keys.json");
  write_file_atomically(root() / "torn.json", std::string(kKeys).substr(0, 90));
  write_file_atomically(root() / "taken" / "file", "mine");
  const std::pair<std::string, std::pair<int, const char*>> cases[] = {
      {"--path " + quoted(root() / "torn.json") + out, {3, "no JSON object"}},
      {"--path " + quoted(root() / "none.json") + out, {3, "none.json"}},
      {"--path orbit --size 63x48" + out, {2, "even"}},
      {"--path orbit --size 64" + out, {2, "no size"}},
      {"--path orbit --size 64x99999" + out, {2, "no size"}},
      {"--path orbit -o " + quoted(root() / "taken"), {2, "taken"}},
      {"--path orbit -o " + quoted(root() / "run" / "renders" / "x.mp4"), {2, "belongs to the run"}},
      {keys + " -o " + quoted(root() / "keys.json"), {2, "source"}},
      {keys + " --at 3 -o " + quoted(root() / "out" / "a.png"), {2, "not on the way"}},
      {keys + " --at 1" + out, {2, "--at is the time of one picture"}},
      {keys + " --at 1", {2, "--at"}},
      {keys + " --fps 5 -o " + quoted(root() / "out" / "a.png"), {2, "--fps is for a video"}},
      {"--path orbi" + out, {3, "orbit, walk"}},
      {"--path orbit --split test" + out, {2, "excludes"}},
      {"--view a --path orbit" + out, {2, "excludes"}},
  };
  for (const auto& [arguments, expected] : cases) {
    const ProcessResult result = aligngs("render " + quoted(root() / "run") + " -q " + arguments);
    EXPECT_EQ(result.status, expected.first) << arguments << result.err;
    EXPECT_THAT(result.err, HasSubstr(expected.second)) << arguments;
  }
  EXPECT_EQ(files(root() / "out"), 0u);
  EXPECT_EQ(read_file(root() / "keys.json"), kKeys);
}

TEST_F(CameraPathCommand, CtrlCLeavesNothingHalfWritten) {
  const std::string old = std::string("old, ") + kDrawnMark;
  write_file_atomically(root() / "out" / "old.mp4", old);
  const auto begun = [] {
    for (const auto& entry : fs::directory_iterator(root() / "out")) {
      if (entry.path().filename().string().find(".tmp-") != std::string::npos) return true;
    }
    return false;
  };
  for (const char* output : {"old.mp4", "frames"}) {
    StartedProcess process({"render", (root() / "run").string(), "--path", "orbit", "--seconds", "3000", "--size",
                            "640x480", "-o", (root() / "out" / output).string()},
                           root() / "scratch");
    ASSERT_TRUE(wait_until(begun, kPatienceToRender)) << process.err();
    process.send(SIGINT);
    EXPECT_EQ(process.wait(kPatienceToRender), 75) << process.err();
    EXPECT_THAT(process.err(), HasSubstr("Ctrl-C was heard"));
    EXPECT_EQ(files(root() / "out"), 1u) << output;
    EXPECT_EQ(read_file(root() / "out" / "old.mp4"), old);
  }
}

}  // namespace
}  // namespace aligngs
