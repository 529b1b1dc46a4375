#include "train/training_set.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "scene/testing/scene_folder.h"

namespace aligngs {
namespace {

TEST(TrainingSet, NearPlaneFollowsTheNearestPriorDepth) {
  const TrainConfig config = make_preset(Preset::kDefault);  // 0.02 of the extent, half of the nearest depth
  ImageF depth(20, 20, 1, 2.0f);
  EXPECT_FLOAT_EQ(near_plane_of({}, config, 10), 0.2f);
  EXPECT_FLOAT_EQ(near_plane_of(depth, config, 10), 1.0f);
  depth.at(3, 3) = 0.01f;  // one wrong pixel of 400
  EXPECT_FLOAT_EQ(near_plane_of(depth, config, 10), 1.0f);
  EXPECT_FLOAT_EQ(near_plane_of(depth, config, 100), 2.0f);
  EXPECT_FLOAT_EQ(near_plane_of(ImageF(20, 20, 1, 0.0f), config, 10), 0.2f);
}

TEST(TrainingSet, PaperHasOneNearPlane) {
  EXPECT_FLOAT_EQ(near_plane_of(ImageF(20, 20, 1, 2.0f), make_preset(Preset::kPaper), 10), 0.2f);
}

TEST(TrainingSet, StartsAreLimitedPerPixel) {
  TrainConfig config = make_preset(Preset::kDefault);
  EXPECT_EQ(start_limit(config, 100000), 120000);
  EXPECT_EQ(start_limit(config, 10000000), 250000);
  config.init.gaussians_per_pixel = 0;
  EXPECT_EQ(start_limit(config, 100), 250000);
}

Scene scene_with(const std::string& depth_source) {
  Scene scene = open_scene(test_scene::write_scene());
  scene.prior_source = depth_source;
  return scene;
}

TEST(TrainingSet, UseOfPriorDepthFollowsTheSetting) {
  Scene scene = scene_with("simulated");
  TrainConfig told = make_preset(Preset::kDefault);
  EXPECT_EQ(decide_prior_use(scene, told).depth, PriorDepthKind::kMetric);
  told.data.prior_depth = PriorDepthUse::kRelative;
  EXPECT_EQ(decide_prior_use(scene, told).depth, PriorDepthKind::kRelative);
  told.data.prior_depth = PriorDepthUse::kMetric;
  scene.depth_scale = DepthScale::kPerView;
  scene.depth_scale_stated = false;  // it is assumed
  EXPECT_EQ(decide_prior_use(scene, told).placement.count(PlacedBy::kCameras), scene.train.size());
  told.data.prior_depth = PriorDepthUse::kNone;
  EXPECT_EQ(decide_prior_use(scene, told).depth, PriorDepthKind::kNone);
  EXPECT_TRUE(decide_prior_use(scene, told).warnings.empty());  // it was asked for
}

TEST(TrainingSet, PredictedBytesCoverWhatIsLoaded) {
  const Scene scene = scene_with("simulated");
  const TrainConfig config = make_preset(Preset::kDefault);
  const PriorUse use = decide_prior_use(scene, config);
  ThreadPool pool(1);
  const std::vector<TrainingView> views = load_training_views(scene, config, use, pool);
  uint64_t bytes = 0;
  for (const TrainingView& v : views) {
    bytes +=
        4 * (v.data.color.data.size() + v.data.mask.data.size() + v.data.prior_depth.data.size() +
             v.depth_weight.data.size() + v.prior_normal.data.size() + v.semantic_weight.data.size()) +
        2 * (v.data.semantics.probabilities.size() + v.data.labels.data.size()) +
        4 * (v.data.semantics.confidence.size() + v.data.semantics.scale.size() + v.data.semantics.score_sum.size()) +
        v.label_edge.data.size();
  }
  for (const GuideView& g : guides_of(views, use, config, 1))
    bytes += 4 * (g.prior_depth.data.size() + g.depth_weight.data.size());
  EXPECT_GE(predicted_view_bytes(scene, config, use), bytes);
  EXPECT_LE(predicted_view_bytes(scene, config, use), 2 * bytes);
}

TEST(TrainingSet, ConfidenceWeighsPriorDepth) {
  const Scene scene = scene_with("simulated");
  TrainConfig config = make_preset(Preset::kDefault);
  const PriorUse use = decide_prior_use(scene, config);
  std::vector<float> confidence(test_scene::kWidth * test_scene::kHeight);
  for (size_t i = 0; i < confidence.size(); ++i) confidence[i] = static_cast<float>(i);  // rises from the top row down
  std::filesystem::create_directories(scene.folder / "pred_confidence");
  const std::filesystem::path path = scene.folder / "pred_confidence" / "v0.npy";
  write_npy_float32(path, {test_scene::kHeight, test_scene::kWidth}, confidence.data());
  ThreadPool pool(1);
  ImageF weight = load_training_views(scene, config, use, pool)[0].depth_weight;
  EXPECT_EQ(weight.at(20, 2), 0);
  EXPECT_EQ(weight.at(20, 25), 1);
  config.data.prior_confidence = false;
  weight = load_training_views(scene, config, use, pool)[0].depth_weight;
  EXPECT_EQ(weight.at(20, 2), 1);
  config.data.prior_confidence = true;
  write_npy_float32(path, {7, 3}, confidence.data());
  EXPECT_THROW(check_prior_confidence(scene, config, use), Error);
}

TEST(TrainingSet, PlacedPriorDepthHasTheScaleOfTheScene) {
  const Scene scene = scene_with("simulated");
  TrainConfig config = make_preset(Preset::kDefault);
  PriorUse use = decide_prior_use(scene, config);
  ThreadPool pool(1);
  const ImageF trained = load_training_views(scene, config, use, pool)[1].data.prior_depth;
  EXPECT_EQ(placed_prior_depth(scene, config, use, 1).data, trained.data);
  use.placement.views.assign(scene.train.size(), {2});
  const ImageF twice = placed_prior_depth(scene, config, use, 1);
  for (size_t i = 0; i < twice.data.size(); ++i) EXPECT_FLOAT_EQ(twice.data[i], 2 * trained.data[i]);
  use.placement.views[1].factor = 0;
  EXPECT_TRUE(placed_prior_depth(scene, config, use, 1).empty()) << "nothing tells its scale";
  config.data.prior_depth = PriorDepthUse::kRelative;
  EXPECT_TRUE(placed_prior_depth(scene, config, decide_prior_use(scene, config), 1).empty());
}

TEST(TrainingSet, TheOpacityControlHasTheWeightsOfTheBoundedCoupling) {
  Scene scene = scene_with("simulated");
  std::vector<float> scores(3 * 15 * 20);  // [class][row][column]: surer from pixel to pixel
  for (size_t i = 0; i < 300; ++i) {
    scores[i] = 0.5f + 0.0015f * static_cast<float>(i);
    scores[300 + i] = 1 - scores[i];
  }
  test_scene::replace_semantics(scene.folder, "v0", {3, 15, 20}, scores);
  scene.views[0].semantics.replace_extension(".npy");
  TrainConfig config = make_preset(Preset::kDefault);
  config.semantic.coupling_strength = 0.1;
  const PriorUse use = decide_prior_use(scene, config);
  ThreadPool pool(1);
  config.semantic.coupling = SemanticCoupling::kBounded;
  const ImageF bounded = load_training_views(scene, config, use, pool)[0].semantic_weight;
  config.semantic.coupling = SemanticCoupling::kOpacity;
  const ImageF opacity = load_training_views(scene, config, use, pool)[0].semantic_weight;
  ASSERT_FALSE(bounded.empty());
  EXPECT_NE(*std::min_element(bounded.data.begin(), bounded.data.end()),
            *std::max_element(bounded.data.begin(), bounded.data.end()))
      << "the test tells nothing where omega is even";
  EXPECT_EQ(opacity.data, bounded.data);
}

TEST(TrainingSet, PlainOrAbsentCouplingNeedsNoWeights) {
  const Scene scene = scene_with("simulated");
  TrainConfig config = make_preset(Preset::kDefault);
  const PriorUse use = decide_prior_use(scene, config);
  ThreadPool pool(1);
  config.semantic.coupling = SemanticCoupling::kOpacity;  // of strength 0
  EXPECT_TRUE(load_training_views(scene, config, use, pool)[0].semantic_weight.empty());
  config.semantic.coupling = SemanticCoupling::kPlain;
  config.semantic.coupling_strength = 1;
  EXPECT_TRUE(load_training_views(scene, config, use, pool)[0].semantic_weight.empty());
}

TEST(TrainingSet, PreviewWorksAtHalfTheSize) {
  const Scene scene = scene_with("simulated");
  const Camera camera = working_camera(scene, make_preset(Preset::kPreview), scene.train[0]);
  EXPECT_EQ(camera.width, test_scene::kWidth / 2);
  EXPECT_EQ(camera.height, test_scene::kHeight / 2);
}

}  // namespace
}  // namespace aligngs
