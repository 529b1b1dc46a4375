#include "scene/exposure_prediction.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

/// A walk of 12 photos; every third is a test photo. `gain` of a training photo's number.
template <class Gain>
Scene walk(Gain gain) {
  Scene scene;
  for (int i = 0; i < 12; ++i) {
    View view;
    view.name = std::to_string(i);
    view.camera.width = view.camera.height = 10;
    view.camera.fx = view.camera.fy = 10;
    view.camera.world_to_camera.translation = {-0.3 * i, 0, 0};
    const bool test = i % 3 == 1;
    if (!test) view.log_gain = Vec3f{1, 1, 1} * static_cast<float>(gain(i));
    (test ? scene.test : scene.train).push_back(i);
    scene.views.push_back(view);
  }
  return scene;
}

TEST(PredictLogGains, ATestPhotoIsExposedAsItsNeighboursAre) {
  const auto slope = [](int i) { return 0.1 * i - 0.5; };
  const Scene scene = walk(slope);
  const std::vector<Vec3f> gains = predict_log_gains(scene);
  for (const int t : scene.train)
    EXPECT_EQ(gains[static_cast<size_t>(t)].x, scene.views[static_cast<size_t>(t)].log_gain.x);
  for (const int t : scene.test) EXPECT_NEAR(gains[static_cast<size_t>(t)].y, slope(t), 0.06) << t;
}

TEST(PredictLogGains, ExposuresSetByChancePredictNothing) {
  const Scene scene = walk([](int i) { return i % 2 == 0 ? 0.2 : -0.2; });
  const std::vector<Vec3f> gains = predict_log_gains(scene);
  for (const int t : scene.test) EXPECT_EQ(gains[static_cast<size_t>(t)].x, 0) << t;
}

TEST(PredictLogGains, WithoutGainsOrTrainingViewsThereAreNone) {
  for (const Vec3f& gain : predict_log_gains(walk([](int) { return 0; }))) EXPECT_EQ(gain.x, 0);
  Scene alone;
  alone.views.resize(2);
  alone.test = {0, 1};
  for (const Vec3f& gain : predict_log_gains(alone)) EXPECT_EQ(gain.x, 0);
}

}  // namespace
}  // namespace aligngs
