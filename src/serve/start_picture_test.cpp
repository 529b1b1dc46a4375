// The picture over a real socket: of a run that is finished, and a pixel in place of none.
#include "serve/start_picture.h"

#include <chrono>

#include "gaussians/gaussian_ply.h"
#include "io/image_file.h"
#include "serve/view_server_for_tests.h"

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

constexpr const char* kCameras = R"([
  {"position": [0, 0, -3], "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
  {"position": [-1, 0, 0], "rotation": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]}])";

class StartPictureOfARun : public testing_support::ViewServerTest {
 protected:
  void configure(ViewServerOptions& options) override {
    write_gaussian_ply(base_ / "run" / "scene.ply", ball());
    write("run/cameras.json", kCameras);
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
  GaussianModel green = ball();
  green.sh[0] = 0;
  green.sh[1] = 1.7f;
  write_gaussian_ply(base_ / "run" / "scene.ply", green);
  EXPECT_EQ(header(get("/api/start.jpg"), "Content-Type"), "image/png") << "nobody waits for the new one";
  const std::string after = answer();
  EXPECT_NE(header(after, "ETag"), header(before, "ETag"));
  EXPECT_GT(decode_image(body(after), "start.jpg").at(528, 352, 1), 200);
}

TEST_F(StartPictureOfARun, IsAPixelWithEdits) {
  answer();
  write("run/run.json", R"({"scene": "scene", "status": "done", "stage": "train"})");
  std::filesystem::create_directories(base_ / "run" / "checkpoints");
  write("run/edits.json", R"({"schema": 1, "edits": [{"edit": "delete", "object": "ball"}]})");
  const std::string told = get("/api/start.jpg");
  const bool edited = get("/api/state").find("\"edited\":true") != std::string::npos;
  ASSERT_TRUE(edited) << "the run of this test counts as edited";
  EXPECT_EQ(header(told, "Content-Type"), "image/png");
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
