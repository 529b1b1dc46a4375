#include "refine/completed_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/srgb.h"
#include "io/npy.h"
#include "refine/testing/wall_photos.h"
#include "scene/scene_writer.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using namespace wall_photos;

/// A scene folder of four training photos with their true depth, and one test photo.
class CompletedScene : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) / "completed_scene" /
            testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(root_);
    fs::create_directories(root_);
  }

  /// `gain`: of the light of the first photo. `depth`: whether the photos have any.
  /// `hole`: side of a square in the middle of each photo where the sensor has none.
  void write(float gain, bool depth = true, int hole = 0) {
    SceneWriter writer(root_ / "scene", false);
    SceneParts parts;
    parts.split.train.emplace();
    parts.split.test.emplace();
    for (int i = 0; i < 5; ++i) {
      const RefineView shown = photo(true_camera(i));
      SceneViewParts view;
      view.name = "v" + std::to_string(i);
      view.camera = shown.match.camera;
      view.image = Image<uint8_t>(kWidth, kHeight, 3);
      for (size_t p = 0; p < view.image.data.size(); ++p) {
        const float light = srgb_decode(0.7f * shown.match.luma.data[p / 3]) * (i == 0 ? gain : 1);
        view.image.data[p] = static_cast<uint8_t>(255 * std::clamp(srgb_encode(light), 0.0f, 1.0f) + 0.5f);
      }
      if (depth) view.prior_depth = shown.match.depth;
      for (int y = (kHeight - hole) / 2; depth && y < (kHeight + hole) / 2; ++y) {
        for (int x = (kWidth - hole) / 2; x < (kWidth + hole) / 2; ++x) view.prior_depth.at(x, y) = 0;
      }
      for (int k = 5; k < kWidth; k += 10) {
        parts.cloud.positions.push_back(
            view.camera.unproject(k + 0.5, 60.5, static_cast<double>(shown.match.depth.at(k, 60))).cast<float>());
        parts.cloud.colors.push_back({0.5f, 0.5f, 0.5f});
      }
      (i == 4 ? parts.split.test : parts.split.train)->push_back(view.name);
      writer.add_view(view);
    }
    parts.priors.depth = PriorJson{kSensorDepth, "", {}};
    parts.priors.depth_scale = DepthScale::kScene;
    writer.finish(parts);
  }

  CompleteSceneReport complete(const CompleteSceneOptions& options = {}) {
    ThreadPool pool(2);
    return complete_scene(open_scene(root_ / "scene"), root_ / "completed", options, pool);
  }

  fs::path root_;
};

TEST_F(CompletedScene, KnowsTheGainOfEachTrainingPhotoAndKeepsTheRest) {
  write(1.3f);
  const CompleteSceneReport report = complete();
  ASSERT_TRUE(report.exposed);
  EXPECT_NEAR(report.span, std::log(1.3), 0.03);
  const Scene before = open_scene(root_ / "scene"), after = open_scene(root_ / "completed");
  EXPECT_NEAR(after.views[0].log_gain[0] - after.views[1].log_gain[0], std::log(1.3), 0.03);
  EXPECT_EQ(after.prior_source, kSensorDepth);
  for (size_t i = 0; i < before.views.size(); ++i) {
    EXPECT_EQ(after.views[i].camera.world_to_camera.translation.x,
              before.views[i].camera.world_to_camera.translation.x);
  }
}

TEST_F(CompletedScene, IsNotWrittenWherePhotosAreExposedAlike) {
  write(1);
  const CompleteSceneReport report = complete();
  EXPECT_FALSE(report.exposed);
  EXPECT_LT(report.span, 0.03);
  EXPECT_FALSE(fs::exists(root_ / "completed"));
}

TEST_F(CompletedScene, LeavesOutPixelsThatMixTwoSurfaces) {
  write(1);
  const fs::path file = root_ / "scene" / "pred_depths" / "v1.npy";
  FloatArray depth = read_npy(file);
  for (int y = 0; y < kHeight; ++y) depth.data[static_cast<size_t>(y * kWidth + 50)] *= 1.4f;  // a column flies
  write_npy_float32(file, {kHeight, kWidth}, depth.data.data());
  EXPECT_FALSE(complete().cleaned) << "not asked for";
  CompleteSceneOptions options;
  options.clean = true;
  options.holes = false;
  const CompleteSceneReport report = complete(options);
  ASSERT_TRUE(report.cleaned);
  EXPECT_NEAR(report.mixed, 0.25 / kWidth, 0.002);
  const FloatArray after = read_npy(root_ / "completed" / "pred_depths" / "v1.npy"),
                   confidence = read_npy(root_ / "completed" / "pred_confidence" / "v1.npy");
  EXPECT_EQ(after.data[static_cast<size_t>(60 * kWidth + 50)], 0);
  EXPECT_EQ(confidence.data[static_cast<size_t>(60 * kWidth + 50)], 0);
  EXPECT_EQ(after.data[static_cast<size_t>(60 * kWidth + 30)], depth.data[static_cast<size_t>(60 * kWidth + 30)]);
  EXPECT_GT(confidence.data[static_cast<size_t>(60 * kWidth + 30)], 0);
}

TEST_F(CompletedScene, DepthThatIsNoSensorsIsNotCleaned) {
  write(1.3f);
  PriorsJson priors = read_priors_json(root_ / "scene" / "priors.json");
  priors.depth->model = "somebody";
  write_priors_json(root_ / "scene" / "priors.json", priors);
  CompleteSceneOptions options;
  options.clean = true;
  options.clean_settings.dark = 2;  // all would be doubtful
  EXPECT_FALSE(complete(options).cleaned);
}

TEST_F(CompletedScene, CamerasAreCheckedAndStayWhereTheyAgree) {
  write(1);
  CompleteSceneOptions options;
  options.check_cameras = options.correct_cameras = true;
  options.holes = false;
  const CompleteSceneReport report = complete(options);
  EXPECT_GT(report.cameras.matches, 200u);
  EXPECT_LT(report.cameras.before, 0.5);
  EXPECT_FALSE(report.corrected);
  EXPECT_FALSE(fs::exists(root_ / "completed"));
}

TEST_F(CompletedScene, WrongCamerasAreWrittenCorrected) {
  write(1);
  Scene scene = open_scene(root_ / "scene");
  Random random(7);
  for (int i = 0; i < 5; ++i) scene.views[static_cast<size_t>(i)].camera = disturbed(true_camera(i), 1.0, 0.01, random);
  CompleteSceneOptions options;
  options.correct_cameras = true;
  options.holes = options.exposure = false;
  ThreadPool pool(2);
  const CompleteSceneReport report = complete_scene(scene, root_ / "completed", options, pool);
  ASSERT_TRUE(report.corrected);
  EXPECT_LT(report.cameras.after, 0.5 * report.cameras.before);
  const auto cameras_of = [](const Scene& s) {
    std::vector<Camera> cameras;
    for (const View& view : s.views) cameras.push_back(view.camera);
    return cameras;
  };
  const Scene after = open_scene(root_ / "completed");
  EXPECT_LT(pair_error(cameras_of(after)), 0.5 * pair_error(cameras_of(scene)));  // the test photo's, too
  EXPECT_EQ(after.cloud.size(), scene.cloud.size());
}

TEST_F(CompletedScene, NeedsDepthOfEveryTrainingPhoto) {
  write(1.3f, false);
  EXPECT_THROW(complete(), Error);
  EXPECT_FALSE(fs::exists(root_ / "completed"));
}

TEST_F(CompletedScene, ReplacesItselfWhereARunWorksOnItsOwnCopy) {
  write(1.3f);
  CompleteSceneOptions options;
  options.overwrite = options.in_place = true;
  ThreadPool pool(2);
  EXPECT_TRUE(complete_scene(open_scene(root_ / "scene"), root_ / "scene", options, pool).exposed);
  EXPECT_TRUE(fs::exists(root_ / "scene" / "exposure.json"));
}

TEST_F(CompletedScene, HasDepthInTheHolesOfTheSensorWithLessConfidence) {
  write(1, true, 40);
  const CompleteSceneReport report = complete();
  ASSERT_TRUE(report.completed);
  EXPECT_FALSE(report.exposed);
  EXPECT_NEAR(report.holes, 1600.0 / (kWidth * kHeight), 1e-3);
  EXPECT_GT(report.filled, 0.6 * report.holes);
  EXPECT_LT(report.disagreement, 0.02);
  const FloatArray depth = read_npy(root_ / "completed" / "pred_depths" / "v1.npy"),
                   confidence = read_npy(root_ / "completed" / "pred_confidence" / "v1.npy");
  const ImageF truth = photo(true_camera(1)).match.depth;
  int right = 0, filled = 0;
  for (size_t i = 0; i < depth.data.size(); ++i) {
    if (confidence.data[i] == 1) {
      EXPECT_FLOAT_EQ(depth.data[i], truth.data[i]);
    }
    if (!(confidence.data[i] > 0 && confidence.data[i] <= kFilledConfidence)) continue;
    ++filled;
    right += std::abs(std::log(depth.data[i] / truth.data[i])) < 0.03;
  }
  EXPECT_GT(right, 0.9 * filled);
}

TEST_F(CompletedScene, SmallHolesAreLeftToTraining) {
  write(1, true, 6);
  EXPECT_FALSE(complete().completed);
}

}  // namespace
}  // namespace aligngs
