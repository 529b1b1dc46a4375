// The picture over a real socket: of a run that is finished, edited or in training, and a pixel in place of none.
#include "serve/start_picture.h"

#include <chrono>

#include "gaussians/gaussian_ply.h"
#include "io/image_file.h"
#include "serve/testing/view_server.h"
#include "train/run_control.h"

namespace aligngs {
namespace {

using test_http::body;
using test_http::header;
using test_http::status;

/// One bright Gaussian at the origin.
GaussianModel ball() {
  GaussianModel model;
  model.resize(1);
  model.positions = {0, 0, 0};
  model.log_scales = {-1, -1, -1};
  model.rotations = {1, 0, 0, 0};
  model.opacity_logits = {5};
  model.sh.assign(model.sh.size(), 0);
  model.sh[0] = 1.7f;  // red is full, the others are grey
  return model;
}

GaussianModel green_ball() {
  GaussianModel model = ball();
  std::swap(model.sh[0], model.sh[1]);
  return model;
}

constexpr const char* kCameras = R"([
  {"position": [0, 0, -3], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
  {"position": [-1, 0, 0], "rotation": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]}])";

class StartPictureOfARun : public testing_support::ViewServerTest {
 protected:
  void configure(ViewServerOptions& options) override {
    write_gaussian_ply(base_ / "run" / "scene.ply", ball());
    write("run/cameras.json", kCameras);
    write("run/run.json", R"({"scene": "scene", "status": "done", "stage": "train"})");
    begin(options);
  }
  void TearDown() override {
    ViewServerTest::TearDown();
    service_.reset();
  }
  void begin(ViewServerOptions& options) {
    service_ = std::make_unique<StartPicture>(options.run, false, std::filesystem::path(), 1);
    service_->serve(options);
  }
  /// Asks until there is a picture; the last answer after some seconds.
  std::string answer() {
    std::string told;
    for (int i = 0; i < 200; ++i) {
      told = get("/api/start.jpg");
      if (header(told, "Content-Type") == "image/jpeg") break;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return told;
  }
  std::unique_ptr<StartPicture> service_;
};

TEST_F(StartPictureOfARun, ShowsWhatTheSplatsShow) {
  const std::string told = answer();
  ASSERT_EQ(status(told), 200);
  ASSERT_EQ(header(told, "Content-Type"), "image/jpeg");
  const Image<uint8_t> picture = decode_image(body(told), "start.jpg");
  EXPECT_EQ(picture.width, 1056);
  EXPECT_EQ(picture.height, 704);
  EXPECT_GT(picture.at(528, 352, 0), 200);  // the ball in the middle
  EXPECT_LT(picture.at(528, 352, 1), 180);
  EXPECT_LT(picture.at(10, 10, 0), 10);  // and nothing in a corner
}

TEST_F(StartPictureOfARun, FollowsANewVersionOfTheSplats) {
  const std::string before = answer();
  write_gaussian_ply(base_ / "run" / "scene.ply", green_ball());
  EXPECT_EQ(header(get("/api/start.jpg"), "Content-Type"), "image/png") << "nobody waits for the new one";
  const std::string after = answer();
  EXPECT_NE(header(after, "ETag"), header(before, "ETag"));
  EXPECT_GT(decode_image(body(after), "start.jpg").at(528, 352, 1), 200);
}

TEST_F(StartPictureOfARun, IsThatOfTheEditedRoomAndOfTheTrainedOneAfterUndo) {
  const std::string trained = answer();
  write("run/edits.json", R"({"schema": 1, "edits": [{"edit": "recolor", "object": "ball"}]})");
  ASSERT_NE(get("/api/state").find("\"edited\":true"), std::string::npos);
  EXPECT_EQ(header(get("/api/start.jpg"), "Content-Type"), "image/png") << "nobody has told the edited splats";
  service_->edited(green_ball());
  const std::string edited = answer();
  ASSERT_EQ(header(edited, "Content-Type"), "image/jpeg");
  EXPECT_GT(decode_image(body(edited), "start.jpg").at(528, 352, 1), 200);
  EXPECT_LT(decode_image(body(edited), "start.jpg").at(528, 352, 0), 180);
  std::filesystem::remove(base_ / "run" / "edits.json");
  EXPECT_EQ(body(get("/api/start.jpg")), body(trained)) << "it was kept";
}

TEST_F(StartPictureOfARun, AnEditThatWasUndoneAtOnceIsNotDrawn) {
  answer();
  const std::string edits = R"({"schema": 1, "edits": [{"edit": "recolor", "object": "ball"}]})";
  write("run/edits.json", edits);
  const auto time = std::filesystem::last_write_time(base_ / "run" / "edits.json");
  service_->edited(green_ball());
  std::filesystem::remove(base_ / "run" / "edits.json");
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  write("run/edits.json", edits);  // the edit is done again
  std::filesystem::last_write_time(base_ / "run" / "edits.json", time);
  EXPECT_EQ(header(get("/api/start.jpg"), "Content-Type"), "image/png");
  service_->edited(green_ball());
  EXPECT_EQ(header(answer(), "Content-Type"), "image/jpeg") << "and is drawn then";
}

TEST_F(StartPictureOfARun, IsTheOneBeforeDuringATraining) {
  answer();
  std::filesystem::create_directories(base_ / "run" / "live");
  write_gaussian_ply(base_ / "run" / "live" / "scene.ply", green_ball());
  const RunLock lock(base_ / "run");
  EXPECT_EQ(header(get("/api/start.jpg"), "Content-Type"), "image/png") << "the trained room is another one";
  const std::string first = answer();
  ASSERT_EQ(header(first, "Content-Type"), "image/jpeg");
  write_gaussian_ply(base_ / "run" / "live" / "scene.ply", ball());
  EXPECT_EQ(body(get("/api/start.jpg")), body(first)) << "an old picture is better than none";
  std::string next = first;
  for (int i = 0; i < 200 && body(next) == body(first); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    next = get("/api/start.jpg");
  }
  EXPECT_GT(decode_image(body(next), "start.jpg").at(528, 352, 0), 200) << "the new snapshot follows";
}

class StartPictureOfNoRoom : public StartPictureOfARun {
  void configure(ViewServerOptions& options) override { begin(options); }  // scene.ply is no PLY file, and no cameras
};

TEST_F(StartPictureOfNoRoom, IsATransparentPixel) {
  const std::string told = get("/api/start.jpg");
  ASSERT_EQ(status(told), 200);
  const Image<uint8_t> pixel = decode_image(body(told), "start.png");
  EXPECT_EQ(pixel.width, 1);
  ASSERT_EQ(pixel.channels, 4);
  EXPECT_EQ(pixel.at(0, 0, 3), 0);
}

TEST_F(StartPictureOfNoRoom, DamagedSplatsAreATransparentPixelToo) {
  write("run/cameras.json", kCameras);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(header(get("/api/start.jpg"), "Content-Type"), "image/png");
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

}  // namespace
}  // namespace aligngs
