#include "scene/view_data.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/half.h"
#include "core/srgb.h"
#include "io/image_file.h"
#include "scene/scene_json.h"
#include "scene/testing/scene_folder.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

using namespace test_scene;

TEST(LoadView, EverythingHasTheSizeOfTheCamera) {
  const ViewData data = load_view(open_scene(write_scene()), 0);
  EXPECT_EQ(data.name, "v0");
  EXPECT_EQ(data.color.width, kWidth);
  EXPECT_EQ(data.color.channels, 3);
  EXPECT_TRUE(data.mask.empty());
  EXPECT_EQ(data.prior_depth.height, kHeight);
  EXPECT_EQ(data.labels.width, kWidth);
  EXPECT_EQ(data.semantics.width, kWidth / 2);
  EXPECT_FLOAT_EQ(data.color.at(3, 2, 1), static_cast<float>(textured_image(1).at(3, 2, 1)) / 255.0f);
}

TEST(LoadView, HalfScaleHalvesCameraAndMaps) {
  LoadOptions options;
  options.scale = 0.5;
  const ViewData data = load_view(open_scene(write_scene()), 1, options);
  EXPECT_EQ(data.camera.width, kWidth / 2);
  EXPECT_EQ(data.camera.fx, 20);
  EXPECT_EQ(data.color.height, kHeight / 2);
  EXPECT_EQ(data.labels.height, kHeight / 2);
  EXPECT_NEAR(data.prior_depth.at(4, 4), surface_depth(data.camera, 4.5, 4.5), 2e-3);
}

TEST(LoadView, ASmallerDepthMapIsSampledAtPixelCentres) {
  const fs::path folder = write_scene();
  const ImageF small = surface_depth_map(camera_at(0), kWidth / 2, kHeight / 2);
  write_npy_float32(folder / "pred_depths" / "v0.npy", {1, kHeight / 2, kWidth / 2}, small.data.data());
  const ViewData data = load_view(open_scene(folder), 0);
  for (int x = 2; x < kWidth - 2; ++x) {
    ASSERT_NEAR(data.prior_depth.at(x, 7), surface_depth(data.camera, x + 0.5, 7.5), 2e-3) << x;
  }
}

TEST(LoadView, DepthWithoutAValueBecomesZero) {
  const fs::path folder = write_scene();
  ImageF depth(kWidth, kHeight, 1, 2.0f);
  depth.at(0, 0) = std::nanf("");
  depth.at(1, 0) = -3;
  depth.at(2, 0) = INFINITY;
  write_npy_float32(folder / "pred_depths" / "v0.npy", {kHeight, kWidth}, depth.data.data());
  const ViewData data = load_view(open_scene(folder), 0);
  for (int x = 0; x < 3; ++x) EXPECT_EQ(data.prior_depth.at(x, 0), 0);
  EXPECT_EQ(data.prior_depth.at(3, 0), 2);
}

TEST(LoadView, ScoresBecomeProbabilitiesAndLabels) {
  const ViewData data = load_view(open_scene(write_scene()), 0);
  ASSERT_EQ(data.semantics.channels, 3);
  EXPECT_EQ(half_to_float(data.semantics.probabilities[0]), 1);
  EXPECT_EQ(data.labels.at(5, 5), 0);
  EXPECT_EQ(data.labels.at(kWidth - 5, 5), 2);
}

TEST(LoadView, PresetPaperTakesScoresAsLogits) {
  LoadOptions options;
  options.scores_as_logits = true;
  const ViewData data = load_view(open_scene(write_scene()), 0, options);
  EXPECT_NEAR(half_to_float(data.semantics.probabilities[0]), std::exp(0.9) / (std::exp(0.9) + 2), 1e-3);
}

TEST(LoadView, ALeadingBatchDimensionIsAccepted) {
  const fs::path folder = write_scene();
  const SemanticMap map = three_class_scores(kWidth, kHeight);
  replace_semantics(folder, "v0", {1, 3, kHeight, kWidth}, map.values);
  EXPECT_EQ(load_view(open_scene(folder), 0).semantics.width, kWidth);
}

TEST(LoadView, PhotosAreExposedAlikeWhenAskedFor) {
  const fs::path folder = write_scene();
  const float plain = load_view(open_scene(folder), 0).color.at(3, 2, 1);
  write_exposure_json(folder / "exposure.json", {{"v0", {0.0f, 0.5f, 0.0f}}});
  const Scene scene = open_scene(folder);
  EXPECT_EQ(load_view(scene, 0).color.at(3, 2, 1), plain);
  LoadOptions options;
  options.exposure = true;
  const ViewData data = load_view(scene, 0, options);
  EXPECT_NEAR(data.color.at(3, 2, 1), srgb_encode(srgb_decode(plain) * std::exp(-0.5f)), 2e-4);
  EXPECT_EQ(data.color.at(3, 2, 0), load_view(scene, 0).color.at(3, 2, 0));
  EXPECT_EQ(load_view(scene, 1, options).color.data, load_view(scene, 1).color.data);
}

TEST(LoadView, AnExposureOfNoViewIsAnError) {
  const fs::path folder = write_scene();
  write_exposure_json(folder / "exposure.json", {{"nobody", {0.0f, 0.5f, 0.0f}}});
  EXPECT_THROW(open_scene(folder), Error);
}

TEST(LoadView, MapsCanBeLeftOut) {
  LoadOptions options;
  options.prior_depth = options.semantics = false;
  const ViewData data = load_view(open_scene(write_scene()), 0, options);
  EXPECT_TRUE(data.prior_depth.empty());
  EXPECT_TRUE(data.semantics.empty());
  EXPECT_TRUE(data.labels.empty());
}

TEST(LoadView, TheAlphaChannelIsTheMask) {
  const fs::path folder = write_scene();
  Image<uint8_t> image = textured_image(1, 4);
  image.at(6, 3, 3) = 0;
  write_png(folder / "images" / "v0.png", image);
  const ViewData data = load_view(open_scene(folder), 0);
  ASSERT_EQ(data.mask.width, kWidth);
  EXPECT_EQ(data.mask.at(6, 3), 0);
  EXPECT_EQ(data.mask.at(7, 3), 1);
  EXPECT_EQ(data.color.channels, 3);
}

TEST(LoadView, AnImpossibleViewOrScaleIsRefused) {
  const Scene scene = open_scene(write_scene());
  EXPECT_THROW(load_view(scene, 3), Error);
  LoadOptions options;
  options.scale = 0;
  EXPECT_THROW(load_view(scene, 0, options), Error);
}

TEST(LoadTruth, DepthIsInMetresAndLabelsHaveNone) {
  const Scene scene = open_scene(write_scene());
  const Camera half = scene.views[0].camera.resized(kWidth / 2, kHeight / 2);
  const ImageF depth = load_truth_depth(scene, 0, half);
  EXPECT_EQ(depth.width, kWidth / 2);
  EXPECT_NEAR(depth.at(10, 7), surface_depth(half, 10.5, 7.5), 0.05);
  const Image<uint16_t> labels = load_truth_labels(scene, 0, scene.views[0].camera);
  EXPECT_EQ(labels.at(0, 0), kNoLabel);
  EXPECT_EQ(labels.at(1, 0), 2);
}

TEST(LoadTruth, ALabelBeyondTheClassesIsAnError) {
  const fs::path folder = write_scene();
  write_png(folder / "truth" / "labels" / "v0.png", Image<uint8_t>(kWidth, kHeight, 1, 3));
  const Scene scene = open_scene(folder);
  EXPECT_THROW(load_truth_labels(scene, 0, scene.views[0].camera), Error);
}

}  // namespace
}  // namespace aligngs
