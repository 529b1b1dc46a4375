#include "priors/scene_from_photos.h"

#include <gmock/gmock.h>

#include <cmath>

#include "io/npy.h"
#include "io/safetensors.h"
#include "priors/testing/from_photos.h"
#include "scene/scene_json.h"
#include "scene/view_data.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

TEST_F(FromPhotos, VggtMakesASceneThatOpensAndChecks) {
  three_photos();
  install_vggt();
  const ScenePhotosReport report = make();
  EXPECT_EQ(report.placed, 3u);
  EXPECT_GT(report.points, 0u);
  const Scene scene = open_scene(folder / "scene");
  ASSERT_EQ(scene.views.size(), 3u);
  EXPECT_TRUE(scene.has_prior_depth());
  EXPECT_TRUE(scene.cloud.has_normals());
  EXPECT_EQ(scene.prior_source, "vggt-1b");
  EXPECT_EQ(read_priors_json(folder / "scene" / "priors.json").depth_scale, DepthScale::kScene);
  for (const SceneProblem& problem : check_scene(scene)) EXPECT_FALSE(problem.fatal) << problem.message;
  const Rigidd& first = scene.views[0].camera.world_to_camera;
  EXPECT_NEAR(norm(first.translation), 0, 1e-9);
  EXPECT_TRUE(fs::exists(folder / "scene" / "pred_confidence" / "a.npy"));
}

TEST_F(FromPhotos, DepthAnything3MakesASceneThatOpensAndChecks) {
  three_photos();
  install_da3();
  options.method = PosesMethod::kDa3;
  options.model = "da3-base";
  const ScenePhotosReport report = make();
  EXPECT_EQ(report.method, "da3-base");
  EXPECT_EQ(report.placed, 3u);
  EXPECT_GT(report.points, 0u);
  const Scene scene = open_scene(folder / "scene");
  EXPECT_TRUE(scene.has_prior_depth());
  EXPECT_TRUE(scene.cloud.has_normals());
  EXPECT_EQ(scene.prior_source, "da3-base");
  for (const SceneProblem& problem : check_scene(scene)) EXPECT_FALSE(problem.fatal) << problem.message;
  EXPECT_NEAR(norm(scene.views[0].camera.world_to_camera.translation), 0, 1e-9);
  EXPECT_TRUE(fs::exists(folder / "scene" / "pred_confidence" / "a.npy"));
}

TEST_F(FromPhotos, AMetricNetworkBesideItMakesMetres) {
  three_photos();
  install_da3();
  options.method = PosesMethod::kDa3;
  options.model = "da3-base";
  make();
  const Scene units = open_scene(folder / "scene");
  EXPECT_FALSE(units.metric);
  EXPECT_FALSE(units.units_estimate);
  const FloatArray depth = read_npy(folder / "scene" / "pred_depths" / "a.npy");

  install_da3_metric();
  options.overwrite = true;
  const ScenePhotosReport report = make();
  ASSERT_TRUE(report.metres);
  EXPECT_EQ(report.metres->photos, 3u);
  const Scene scene = open_scene(folder / "scene");
  EXPECT_TRUE(scene.metric);
  ASSERT_TRUE(scene.units_estimate);
  EXPECT_EQ(scene.units_estimate->model, "da3metric-large");
  EXPECT_EQ(scene.units_estimate->photos, 3);
  EXPECT_NEAR(scene.units_estimate->spread, report.metres->spread, 1e-9);
  const auto baseline = [](const Scene& s) { return norm(s.views[1].camera.centre() - s.views[0].camera.centre()); };
  EXPECT_NEAR(baseline(scene) / baseline(units), report.metres->scale, 1e-6 * report.metres->scale);
  const FloatArray metres = read_npy(folder / "scene" / "pred_depths" / "a.npy");
  ASSERT_EQ(metres.data.size(), depth.data.size());
  for (size_t i = 0; i < depth.data.size(); ++i) {
    // Half floats; depth of the sky and unsure depth are no values.
    if (depth.data[i] > 0 && metres.data[i] > 0) {
      EXPECT_NEAR(metres.data[i] / depth.data[i], report.metres->scale, 2e-3 * report.metres->scale);
    }
  }
}

TEST_F(FromPhotos, AMetricNetworkThatIsAskedForMustBeThere) {
  three_photos();
  install_da3();
  options.method = PosesMethod::kDa3;
  options.model = "da3-base";
  options.metres = MetresChoice::kNetwork;
  EXPECT_THAT(error_of(ErrorKind::kWeights, [&] { make(); }), HasSubstr("aligngs models download da3metric-large"));
  options.metres = MetresChoice::kNone;
  make();
  EXPECT_FALSE(open_scene(folder / "scene").metric);
}

TEST_F(FromPhotos, RaysThatAreThoseOfNoCameraNameThePhoto) {
  three_photos();
  install_da3();
  options.method = PosesMethod::kDa3;
  options.model = "da3-base";
  options.camera_from_rays = true;
  // The camera of rays of random weights is one that no photo has.
  EXPECT_THAT(error_of(ErrorKind::kFailed, [&] { make(); }), AllOf(HasSubstr("a.jpg"), HasSubstr("impossible camera")));
  EXPECT_FALSE(fs::exists(folder / "scene"));
}

TEST_F(FromPhotos, DepthAnything3SeesTheMiddleOfPhotosOfOtherShapes) {
  write_photo("a.jpg", 120, 90);
  write_photo("b.jpg", 90, 120);
  write_photo("c.jpg", 64, 64);
  install_da3("da3-small");
  options.method = PosesMethod::kDa3;
  options.model = "da3-small";
  make();
  const Scene scene = open_scene(folder / "scene");
  EXPECT_EQ(scene.views[1].camera.height, 120);
  EXPECT_NEAR(scene.views[1].camera.cy, 60, 1);
  const FloatArray depth = read_npy(folder / "scene" / "pred_depths" / "b.npy");
  EXPECT_GT(depth.shape[0], depth.shape[1]);
  EXPECT_EQ(depth.data.front(), 0) << "above what the network was shown";
}

TEST_F(FromPhotos, DepthAnything3FillsTheDepthOfASceneInTheUnitsOfItsCameras) {
  three_photos();
  install_da3();
  options.method = PosesMethod::kDa3;
  options.model = "da3-base";
  make();
  fill.overwrite = true;
  const ModelStore store(store_options);
  EXPECT_EQ(fill_depth(folder / "scene", store, depth_model("da3"), fill).written, 3u);
  EXPECT_EQ(read_priors_json(folder / "scene" / "priors.json").depth_scale, DepthScale::kScene);
  EXPECT_TRUE(fs::exists(folder / "scene" / "pred_confidence" / "a.npy"));
  fill.memory_limit = 1'000'000;
  error_of(ErrorKind::kResources, [&] { fill_depth(folder / "scene", store, depth_model("da3"), fill); });
}

TEST_F(FromPhotos, WithoutWeightsOfDepthAnything3ItSaysHowToGetThem) {
  three_photos();
  options.method = PosesMethod::kDa3;
  options.model = "da3-large";
  const std::string text = error_of(ErrorKind::kWeights, [&] { make(); });
  EXPECT_THAT(text, HasSubstr("aligngs models download da3-large"));
  EXPECT_THAT(text, HasSubstr("non-commercial"));
}

TEST_F(FromPhotos, PhotosOfAnySizeAndOrientationGoTogether) {
  write_photo("a.jpg", 120, 90);
  write_photo("b.jpg", 90, 120);
  write_photo("c.jpg", 64, 64);
  install_vggt();
  make();
  const Scene scene = open_scene(folder / "scene");
  EXPECT_EQ(scene.views[1].camera.height, 120);
  EXPECT_NEAR(scene.views[1].camera.cx, 45, 1);
}

TEST_F(FromPhotos, UnsureDepthIsLeftOut) {
  three_photos();
  install_vggt();
  options.drop_percent = 40;
  make();
  size_t none = 0, all = 0;
  for (const char* name : {"a", "b", "c"}) {
    for (const float z : read_npy(folder / "scene" / "pred_depths" / (std::string(name) + ".npy")).data) {
      none += z == 0;
      ++all;
    }
  }
  EXPECT_NEAR(double(none) / double(all), 0.4, 0.02);
}

TEST_F(FromPhotos, OneFocalLengthForAllWhenAskedFor) {
  three_photos();
  install_vggt();
  options.shared_focal = true;
  make();
  const Scene scene = open_scene(folder / "scene");
  EXPECT_DOUBLE_EQ(scene.views[0].camera.fx, scene.views[2].camera.fx);
  EXPECT_DOUBLE_EQ(scene.views[0].camera.fx, scene.views[0].camera.fy);
}

TEST_F(FromPhotos, EveryNthPhotoIsKeptForTesting) {
  for (const char* name : {"1.jpg", "2.jpg", "3.jpg", "4.jpg"}) write_photo(name, 120, 90);
  install_vggt();
  options.test_every = 2;
  EXPECT_EQ(make().test, 2u);
  EXPECT_EQ(open_scene(folder / "scene").test.size(), 2u);
}

TEST_F(FromPhotos, WithoutWeightsNothingIsWritten) {
  three_photos();
  EXPECT_THAT(error_of(ErrorKind::kWeights, [&] { make(); }), HasSubstr("aligngs models download vggt-1b"));
  EXPECT_FALSE(fs::exists(folder / "scene"));
}

TEST_F(FromPhotos, MemoryIsPredictedFirst) {
  three_photos();
  install_vggt();
  options.memory_limit = 1 << 20;
  EXPECT_THAT(error_of(ErrorKind::kResources, [&] { make(); }), HasSubstr("weights of the network"));
}

TEST_F(FromPhotos, AnImpossibleCameraIsRefused) {
  three_photos();
  // Without its bias the head predicts fields of view of nearly nothing.
  install_vggt();
  TensorFile file = read_safetensors(weights_of("vggt-1b"));
  TensorBytes& bias = file.tensors.at("camera_head.pose_branch.fc2.bias");
  bias.bytes.assign(bias.bytes.size(), 0);
  write_safetensors(weights_of("vggt-1b"), file);
  EXPECT_THAT(error_of(ErrorKind::kFailed, [&] { make(); }), HasSubstr("impossible camera"));
  EXPECT_FALSE(fs::exists(folder / "scene"));
}

TEST_F(FromPhotos, ASceneThatExistsIsKept) {
  three_photos();
  install_vggt();
  make();
  error_of(ErrorKind::kUsage, [&] { make(); });
  options.overwrite = true;
  EXPECT_NO_THROW(make());
}

}  // namespace
}  // namespace aligngs
