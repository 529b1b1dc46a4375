#include "train/smallest_scale.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

GuideView view_at(double z, double focal) {
  GuideView view;
  view.camera.width = 100;
  view.camera.height = 80;
  view.camera.fx = view.camera.fy = focal;
  view.camera.cx = 50;
  view.camera.cy = 40;
  view.camera.world_to_camera.translation = {0, 0, -z};
  view.near_plane = 0.1f;
  return view;
}

float floor_of(const Vec3f& position, const std::vector<GuideView>& views, double pixels = 0.7) {
  GaussianModel model;
  model.resize(1);
  for (int k = 0; k < 3; ++k) model.positions[static_cast<size_t>(k)] = position[k];
  ThreadPool pool(1);
  return smallest_log_scales(model, views, pixels, pool)[0];
}

TEST(SmallestScale, IsThatOfTheSharpestView) {
  const std::vector<GuideView> views = {view_at(0, 100), view_at(1, 100), view_at(0, 150)};
  // At z = 2: 50, 100 and 75 pixels per unit.
  EXPECT_NEAR(std::exp(floor_of({0, 0, 2}, views)), 0.7 / 100, 1e-6);
}

TEST(SmallestScale, ViewsThatDoNotSeeItDoNotCount) {
  EXPECT_EQ(floor_of({0, 0, -1}, {view_at(0, 100)}), -INFINITY);
  EXPECT_EQ(floor_of({0, 0, 0.05f}, {view_at(0, 100)}), -INFINITY);
  EXPECT_EQ(floor_of({1.4f, 0, 2}, {view_at(0, 100)}), -INFINITY);                // 20 pixels beside
  EXPECT_NEAR(std::exp(floor_of({1.2f, 0, 2}, {view_at(0, 100)})), 0.014, 1e-6);  // 10 pixels beside
  EXPECT_EQ(floor_of({NAN, 0, 2}, {view_at(0, 100)}), -INFINITY);
  EXPECT_EQ(floor_of({0, 0, 2}, {}), -INFINITY);
}

}  // namespace
}  // namespace aligngs
