#include "edit/fill/hidden_places.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

/// A camera that looks along +z from a place.
Camera camera_at(double x, double z) {
  Camera camera;
  camera.width = camera.height = 100;
  camera.fx = camera.fy = 50;
  camera.cx = camera.cy = 50;
  camera.world_to_camera.translation = {-x, 0, -z};
  return camera;
}

/// A screen of 40 cm at z = 1, seen from z = -1; places are on a wall at z = 2.
class HiddenPlacesTest : public testing::Test {
 protected:
  HiddenPlacesTest() {
    model_.semantic_channels = 0;
    for (float x = -0.2f; x <= 0.2f; x += 0.02f) {
      for (float y = -0.2f; y <= 0.2f; y += 0.02f)
        small_room::add_gaussian(model_, {x, y, 1}, {0, 0, -1}, {0.5f, 0.5f, 0.5f}, -1);
    }
    selected_.assign(model_.size(), 1);
  }
  HiddenPlaces places() const { return HiddenPlaces(model_, selected_, cameras_, kCube); }
  static constexpr double kCube = 0.04;  // metres
  GaussianModel model_;
  std::vector<uint8_t> selected_;
  std::vector<Camera> cameras_ = {camera_at(0, -1)};
};

TEST_F(HiddenPlacesTest, BehindTheScreenAndNotBesideIt) {
  EXPECT_TRUE(places().from_all({0, 0, 2}));
  EXPECT_FALSE(places().from_all({0.8, 0, 2}));
  EXPECT_FALSE(places().from_all({0, 0, 0})) << "before the screen";
}

TEST_F(HiddenPlacesTest, OnePhotoPastTheEdgeShowsThePlace) {
  cameras_ = {camera_at(0, -1), camera_at(0.05, -1), camera_at(2, -1)};
  EXPECT_FALSE(places().from_all({0, 0, 2}));
  EXPECT_TRUE(places().from_most({0, 0, 2}));
}

TEST_F(HiddenPlacesTest, APhotoThatLooksElsewhereSaysNothing) {
  cameras_ = {camera_at(0, -1), camera_at(8, -1)};
  EXPECT_TRUE(places().from_all({0, 0, 2})) << "the second one has the place outside of its picture";
}

TEST_F(HiddenPlacesTest, WhatStaysBlocksPhotosToo) {
  std::fill(selected_.begin(), selected_.end(), uint8_t(0));
  EXPECT_FALSE(places().from_all({0, 0, 2})) << "the screen is not removed";
}

TEST_F(HiddenPlacesTest, APlaceIsOpenWhereAsManyPhotosLookPast) {
  EXPECT_FALSE(places().is_open({0, 0, 2}));
  EXPECT_TRUE(places().is_open({0.8, 0, 2})) << "beside the screen";
  cameras_ = {camera_at(0, -1), camera_at(2, -1)};
  EXPECT_TRUE(places().is_open({0, 0, 2})) << "one of two photos looks past the screen";
}

TEST_F(HiddenPlacesTest, APlaceOutsideOfAllPicturesIsNotOpen) { EXPECT_FALSE(places().is_open({8, 0, 2})); }

TEST_F(HiddenPlacesTest, AnotherThingHidesAPlace) {
  EXPECT_FALSE(places().is_shown({0, 0, 2}));
  std::fill(selected_.begin(), selected_.end(), uint8_t(0));
  EXPECT_FALSE(places().is_shown({0, 0, 2})) << "the screen stays and hides it all the same";
  EXPECT_TRUE(places().is_shown({0.8, 0, 2}));
}

TEST_F(HiddenPlacesTest, AFewLargeGaussiansHaveNoGaps) {
  model_ = GaussianModel();
  for (float x = -0.3f; x <= 0.3f; x += 0.12f) {
    for (float y = -0.3f; y <= 0.3f; y += 0.12f) {
      small_room::add_gaussian(model_, {x, y, 1}, {0, 0, -1}, {0.5f, 0.5f, 0.5f}, -1);
      for (size_t a = 0; a < 2; ++a) model_.log_scales[model_.log_scales.size() - 3 + a] = std::log(0.08f);
    }
  }
  selected_.assign(model_.size(), 1);
  for (double x = -0.4; x <= 0.4; x += 0.02) EXPECT_TRUE(places().from_all({x, 0.1, 2})) << x;
}

}  // namespace
}  // namespace aligngs
