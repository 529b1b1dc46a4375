#include "train/camera_outputs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "scene/import/capture.h"
#include "scene/testing/scene_folder.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class CameraOutputs : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path folder = test_scene::write_scene("scene");
    scene_ = open_scene(folder);
    scene_.views[0].camera.world_to_camera.rotation = rotation_matrix(normalized(Quaterniond{0.9, 0.1, -0.2, 0.3}));
    run_ = test_scene::fresh_folder("run");
    fs::create_directories(run_);
    TrainConfig config;
    config.data.scale = 1;
    write_camera_outputs(RunFolder(run_), scene_, config);
  }

  void expect_same_poses(const Capture& capture) const {
    ASSERT_EQ(capture.frames.size(), scene_.views.size());
    for (const CapturedFrame& frame : capture.frames) {
      const auto view =
          std::find_if(scene_.views.begin(), scene_.views.end(), [&](const View& v) { return v.name == frame.name; });
      ASSERT_NE(view, scene_.views.end()) << frame.name;
      const Rigidd& expected = view->camera.world_to_camera;
      for (int r = 0; r < 3; ++r) {
        EXPECT_NEAR(frame.world_to_camera.translation[r], expected.translation[r], 1e-9);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(frame.world_to_camera.rotation(r, c), expected.rotation(r, c), 1e-9);
      }
      EXPECT_EQ(frame.camera.width, static_cast<uint64_t>(view->camera.width));
      EXPECT_NEAR(frame.camera.params[0], view->camera.fx, 1e-9);
    }
  }

  Scene scene_;
  fs::path run_;
};

TEST_F(CameraOutputs, TransformsAreReadAsTheSamePosesAndSplit) {
  const Capture capture = read_transforms(run_);
  expect_same_poses(capture);
  EXPECT_EQ(capture.train.size(), scene_.train.size());
  EXPECT_EQ(capture.test.size(), scene_.test.size());
}

TEST_F(CameraOutputs, SparseIsAColmapModelWithTheScenesPoints) {
  const ColmapModel model = read_colmap_model(run_ / "sparse" / "0");
  EXPECT_EQ(model.images.size(), scene_.views.size());
  EXPECT_EQ(model.points.size(), scene_.cloud.size());
}

}  // namespace
}  // namespace aligngs
