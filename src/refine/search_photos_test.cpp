#include "refine/search_photos.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

/// A photo of 640 x 480 whose luma rises to the right, with depth 2 on the left and 3 on the right.
MatchView large_photo() {
  MatchView view;
  view.camera.width = 640;
  view.camera.height = 480;
  view.camera.fx = view.camera.fy = 500;
  view.camera.cx = 320;
  view.camera.cy = 240;
  view.luma = ImageF(640, 480, 1);
  view.depth = ImageF(640, 480, 1);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      view.luma.at(x, y) = static_cast<float>(x) / 640;
      view.depth.at(x, y) = x < 320 ? 2.0f : 3.0f;
    }
  }
  return view;
}

TEST(SearchPhotos, ANearSearchLooksAtThePhotosThemselves) {
  const MatchView photo = large_photo();
  const SearchPhotos searched({{0, &photo, nullptr}}, false);
  EXPECT_EQ(&searched.match(0), &photo);
  EXPECT_TRUE(searched.mask(0).empty());
}

TEST(SearchPhotos, AWideOneAtCopiesOf320By240) {
  const MatchView photo = large_photo();
  const ImageF mask(640, 480, 1, 1.0f);
  const SearchPhotos searched({{0, &photo, &mask}}, true);
  const MatchView& copy = searched.match(0);
  EXPECT_EQ(copy.luma.width, 320);
  EXPECT_EQ(copy.luma.height, 240);
  EXPECT_EQ(copy.camera.width, 320);
  EXPECT_DOUBLE_EQ(copy.camera.fx, 250);
  EXPECT_NEAR(copy.luma.at(100, 50), 200.5 / 640, 1e-5);
  EXPECT_EQ(copy.depth.at(159, 0), 2);  // no depth is made up across the step
  EXPECT_EQ(copy.depth.at(160, 0), 3);
  EXPECT_EQ(searched.mask(0).width, 320);
}

TEST(SearchPhotos, PhotosOf320By240AreNotCopied) {
  MatchView photo = large_photo();
  photo.luma = ImageF(320, 240, 1);
  photo.depth = ImageF(320, 240, 1);
  photo.camera = photo.camera.resized(320, 240);
  const SearchPhotos searched({{0, &photo, nullptr}}, true);
  EXPECT_EQ(&searched.match(0), &photo);
}

TEST(SearchPhotos, WhatIsFoundInACopyIsSaidInPixelsOfThePhoto) {
  const MatchView photo = large_photo();
  const SearchPhotos searched({{0, &photo, nullptr}}, true);
  Match found;
  found.pixel = {10.25, 7};
  found.covariance = {1, 0.5, 2};
  const Match match = searched.to_given(0, found);
  EXPECT_DOUBLE_EQ(match.pixel.x, 20.5);
  EXPECT_DOUBLE_EQ(match.pixel.y, 14);
  EXPECT_DOUBLE_EQ(match.covariance.xx, 4);
  EXPECT_DOUBLE_EQ(match.covariance.xy, 2);
  EXPECT_DOUBLE_EQ(match.covariance.yy, 8);
  EXPECT_DOUBLE_EQ(searched.from_given(0, match.pixel).x, 10.25);
}

TEST(SearchPhotos, APhotoThatIsOnlySearchedNeedsNoDepth) {
  MatchView photo = large_photo();
  photo.depth = {};
  EXPECT_TRUE(SearchPhotos({{0, &photo, nullptr}}, true).match(0).depth.empty());
}

}  // namespace
}  // namespace aligngs
