// Prior depth of every kind in metric and arbitrary worlds: the slope of test_scene_folder.h seen by a row of cameras.
#include "scene/depth_placement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "scene/testing/scene_folder.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr double kWorlds[] = {1, 0.37, 12};  // scene units per metre; 1 is a metric scene
constexpr int kViews = 5;
constexpr double kStep = 0.25;   // metres between cameras
constexpr double kClose = 0.01;  // of a factor: half a pixel of the small photos moves the slope's depth by as much

struct Given {
  double world = 1;
  DepthScale scale = DepthScale::kScene;
  double noise = 0;           ///< relative, per pixel
  double wrong_points = 0;    ///< share of the points that lie up to twice as far
  double points_below = 1e9;  ///< metres: only points with a smaller x
  int points = 400;
};

/// A network's unit: what its map of a view holds for a metre.
double unit_of(const Given& given, int view) {
  switch (given.scale) {
    case DepthScale::kScene:
      return given.world;
    case DepthScale::kMetres:
      return 1 + 0.04 * (view - 2);  // a few per cent off in every photo
    case DepthScale::kOwn:
      return 2.7;
    case DepthScale::kPerView:
      return std::pow(3.0, view - 2);
  }
  return 0;
}

Scene scene_of(const Given& given) {
  const fs::path folder = test_scene::fresh_folder("scene");
  SceneWriter writer(folder, false);
  SceneParts parts = test_scene::scene_parts();
  parts.split.train.emplace();
  parts.split.test.reset();
  Random random(3);
  for (int v = 0; v < kViews; ++v) {
    SceneViewParts view;
    view.name = "v" + std::to_string(v);
    const Camera metric = test_scene::camera_at(kStep * v);
    view.prior_depth = test_scene::surface_depth_map(metric, test_scene::kWidth, test_scene::kHeight);
    for (float& z : view.prior_depth.data)
      z *= static_cast<float>(unit_of(given, v) * (1 + given.noise * random.normal()));
    view.camera = metric;
    view.camera.world_to_camera.translation = metric.world_to_camera.translation * given.world;
    view.image = test_scene::textured_image(static_cast<uint64_t>(v));
    writer.add_view(view);
    parts.split.train->push_back(view.name);
  }
  parts.cloud = {};
  for (int i = 0; i < given.points; ++i) {
    const double x = random.uniform(-0.8, 1.6), y = random.uniform(-0.6, 0.6), z = 2 + 0.5 * x;
    const double behind = random.chance(given.wrong_points) ? random.uniform(1, 2) : 1;
    if (x < given.points_below) parts.cloud.positions.push_back((Vec3d{x, y, z * behind} * given.world).cast<float>());
  }
  parts.cloud.colors.assign(parts.cloud.positions.size(), {1, 1, 1});
  parts.description.metric = given.world == 1;
  parts.priors.depth = PriorJson{"simulated", "", {}};
  parts.priors.depth_scale = given.scale;
  parts.priors.semantics.reset();
  writer.finish(parts);
  return open_scene(folder);
}

void expect_factors(const Given& given, const DepthPlacement& placement, double tolerance = kClose) {
  ASSERT_EQ(placement.views.size(), size_t(kViews));
  EXPECT_EQ(placement.scale, given.scale);
  for (int v = 0; v < kViews; ++v) {
    const double want = given.world / unit_of(given, v);
    EXPECT_NEAR(placement.views[static_cast<size_t>(v)].factor / want, 1, tolerance)
        << "view " << v << ", world " << given.world << ": " << describe(placement);
  }
}

TEST(DepthPlacement, DepthOfTheSceneIsTakenAsItIs) {
  for (const double world : kWorlds) {
    Given given{world, DepthScale::kScene};
    const DepthPlacement placement = place_prior_depth(scene_of(given));
    expect_factors(given, placement, 0);
    EXPECT_FALSE(placement.residual) << "it is not read";
  }
}

TEST(DepthPlacement, EveryOtherKindIsLaidOnThePoints) {
  for (const DepthScale scale : {DepthScale::kMetres, DepthScale::kOwn, DepthScale::kPerView}) {
    for (const double world : kWorlds) {
      const Given given{world, scale};
      const DepthPlacement placement = place_prior_depth(scene_of(given));
      expect_factors(given, placement);
      ASSERT_TRUE(placement.residual);
      EXPECT_LT(*placement.residual, kClose);
      EXPECT_EQ(placement.count(PlacedBy::kPoints), size_t(kViews));
    }
  }
}

TEST(DepthPlacement, NoiseAndWrongPointsMoveNoFactorByMuch) {
  for (const DepthScale scale : {DepthScale::kMetres, DepthScale::kOwn, DepthScale::kPerView}) {
    Given given{0.37, scale};
    given.noise = 0.05;
    given.wrong_points = 0.3;
    given.points = 1500;
    const DepthPlacement placement = place_prior_depth(scene_of(given));
    expect_factors(given, placement, 0.03);
    EXPECT_GT(*placement.residual, 0.02);
    EXPECT_LT(*placement.residual, 0.12);
  }
}

TEST(DepthPlacement, ViewsWithoutPointsAreLaidOnTheDepthOfOthers) {
  for (const DepthScale scale : {DepthScale::kMetres, DepthScale::kPerView}) {
    Given given{12, scale};
    given.points_below = -0.2;  // nearly out of the sight of the last views
    const DepthPlacement placement = place_prior_depth(scene_of(given));
    EXPECT_GT(placement.count(PlacedBy::kOtherDepth), 0u);
    expect_factors(given, placement, 2 * kClose);
  }
}

TEST(DepthPlacement, OneScaleReachesViewsWithoutPoints) {
  Given given{12, DepthScale::kOwn};
  given.points_below = -0.2;
  const DepthPlacement placement = place_prior_depth(scene_of(given));
  EXPECT_GT(placement.count(PlacedBy::kOtherViews), 0u);
  expect_factors(given, placement);
}

TEST(DepthPlacement, MetresNeedNoPointsInAMetricScene) {
  Given given{1, DepthScale::kMetres};
  given.points = 0;
  const DepthPlacement placement = place_prior_depth(scene_of(given));
  EXPECT_EQ(placement.count(PlacedBy::kCameras), size_t(kViews));
  ASSERT_TRUE(placement.residual) << "the views see each other's depth";
  EXPECT_GT(*placement.residual, 0.01);
  EXPECT_LT(*placement.residual, 0.1);
}

TEST(DepthPlacement, WithoutPointsNothingTellsAnUnknownScale) {
  for (const auto& [world, scale] :
       {std::pair{1.0, DepthScale::kOwn}, {1.0, DepthScale::kPerView}, {0.37, DepthScale::kMetres}}) {
    Given given{world, scale};
    given.points = 0;
    const DepthPlacement placement = place_prior_depth(scene_of(given));
    EXPECT_EQ(placement.placed(), 0u);
    EXPECT_FALSE(placement.residual);
  }
}

TEST(DepthPlacement, DepthOfOneViewThatFitsNothingShowsInItsResidual) {
  const Given given{1, DepthScale::kPerView};
  const Scene scene = scene_of(given);
  std::vector<float> random_depth(size_t(test_scene::kWidth) * test_scene::kHeight);
  Random random(5);
  for (float& z : random_depth) z = static_cast<float>(std::exp(random.normal()));
  write_npy_float32(scene.views[1].prior_depth, {test_scene::kHeight, test_scene::kWidth}, random_depth.data());
  const DepthPlacement placement = place_prior_depth(scene);
  EXPECT_GT(placement.views[1].residual, 0.3);
  EXPECT_LT(*placement.residual, kClose);
}

TEST(RobustLogScale, FindsTheMajority) {
  Random random(1);
  std::vector<double> ratios;
  for (int i = 0; i < 60; ++i) ratios.push_back(0.7 + 0.01 * random.normal());
  for (int i = 0; i < 40; ++i) ratios.push_back(random.uniform(1.0, 3.0));  // all on one side
  const auto found = robust_log_scale(ratios);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->log, 0.7, 0.005);
  EXPECT_EQ(found->samples, 100u);
}

TEST(RobustLogScale, FewSamplesSayNothing) { EXPECT_FALSE(robust_log_scale(std::vector<double>(29, 0.1))); }

TEST(RobustLogScale, SpreadIsThatOfAllSamples) {
  std::vector<double> ratios(51, 0.0);
  ratios.insert(ratios.end(), 49, 1.0);
  EXPECT_EQ(robust_log_scale(ratios)->spread, 0);
  for (size_t i = 0; i < 51; ++i) ratios[i] = i % 2 == 0 ? -0.05 : 0.05;
  EXPECT_NEAR(robust_log_scale(ratios)->spread, 0.1, 1e-9) << "the centre is one of the two";
}

}  // namespace
}  // namespace aligngs
