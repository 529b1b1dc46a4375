#include "refine/outline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "refine/testing/screen_room.h"

namespace aligngs {
namespace {

using namespace screen_room;

/// The label of a photo, grown by some pixels to each side.
Image<uint8_t> grown(const Image<uint16_t>& labels, int by) {
  Image<uint8_t> out(labels.width, labels.height, 1);
  for (int y = 0; y < labels.height; ++y) {
    for (int x = 0; x < labels.width; ++x) {
      for (int dy = -by; dy <= by; ++dy) {
        for (int dx = -by; dx <= by; ++dx) {
          const int u = x + dx, v = y + dy;
          if (u >= 0 && v >= 0 && u < labels.width && v < labels.height && labels.at(u, v) == kScreenLabel)
            out.at(x, y) = 1;
        }
      }
    }
  }
  return out;
}

struct TwoPhotos {
  Camera from = camera(-0.4, -0.3, -0.1), to = camera(0.5, -0.2, 0.1);
  ScreenPhoto first = photo(from, Screen{}), second = photo(to, Screen{});
  ImageF gradient = luma_gradient(first.luma), other_gradient = luma_gradient(second.luma);

  std::vector<OutlinePoint> outline(int label_grown_by = 0) const {
    return outline_of(grown(first.view.labels, label_grown_by), gradient, {});
  }
  double share(double z) const { return agreement(outline(), from, {{0, 0, -1}, z}, to, other_gradient, {}).share; }
};

TEST(Outline, IsFoundInThePhotoWhereTheLabelIsPixelsOff) {
  const TwoPhotos photos;
  const std::vector<OutlinePoint> outline = photos.outline(3);
  ASSERT_GT(outline.size(), 40u);
  size_t near = 0;
  for (const Vec3d& p : on_plane(outline, photos.from, {{0, 0, -1}, kStanding})) {
    const double across = std::abs(std::abs(p.x) - kHalfWidth),
                 along = std::min(std::abs(p.y - kHigh), std::abs(p.y - kLowStanding));
    near += std::min(across, along) < 0.01 ? 1 : 0;  // a pixel is 11 mm there
  }
  EXPECT_GT(static_cast<double>(near), 0.9 * static_cast<double>(outline.size()));
}

TEST(Outline, RisesAwayFromABlackScreen) {
  const TwoPhotos photos;
  for (const OutlinePoint& p : photos.outline()) {
    const Vec3d inside = photos.from.unproject(p.place.x - 4 * p.rise.x, p.place.y - 4 * p.rise.y, kStanding);
    EXPECT_LT(std::abs(inside.x), kHalfWidth);
  }
}

TEST(Outline, AgreesOnItsPlaneAndNotBesideIt) {
  const TwoPhotos photos;
  EXPECT_GT(photos.share(kStanding), 0.8);
  EXPECT_LT(photos.share(kStanding - 0.37), 0.3);
  EXPECT_LT(photos.share(kStanding + 0.2), 0.5);
  EXPECT_LT(photos.share(kStanding - 0.05), photos.share(kStanding));
}

TEST(Outline, EdgesThatRiseTheOtherWayAreOthers) {
  TwoPhotos photos;
  for (float& g : photos.other_gradient.data) g = -g;
  EXPECT_LT(photos.share(kStanding), 0.1);
}

TEST(Outline, APlaneSeenFromBehindOrMissedByTheOtherPhotoSaysNothing) {
  const TwoPhotos photos;
  const std::vector<OutlinePoint> outline = photos.outline();
  EXPECT_EQ(agreement(outline, photos.from, {{0, 0, 1}, -kStanding}, photos.to, photos.other_gradient, {}).inside, 0);
  Camera away = photos.to;
  away.world_to_camera.rotation = Mat3d{{-1, 0, 0, 0, 1, 0, 0, 0, -1}} * away.world_to_camera.rotation;
  EXPECT_EQ(agreement(outline, photos.from, {{0, 0, -1}, kStanding}, away, photos.other_gradient, {}).inside, 0);
  EXPECT_EQ(agreement({}, photos.from, {{0, 0, -1}, kStanding}, photos.to, photos.other_gradient, {}).share, 0);
  EXPECT_TRUE(on_plane(outline, photos.from, {{0, 0, 1}, -kStanding}).empty());
}

TEST(Outline, AFlatPhotoAndTheBorderHaveNone) {
  const TwoPhotos photos;
  const ImageF flat = luma_gradient(ImageF(kPhotoWidth, kPhotoHeight, 1, 0.5f));
  EXPECT_TRUE(outline_of(grown(photos.first.view.labels, 0), flat, {}).empty());
  EXPECT_TRUE(outline_of(Image<uint8_t>(kPhotoWidth, kPhotoHeight, 1, 1), photos.gradient, {}).empty());
  EXPECT_TRUE(outline_of(Image<uint8_t>(kPhotoWidth, kPhotoHeight, 1, 0), photos.gradient, {}).empty());
}

TEST(Outline, TheGradientOfARampIsItsSlope) {
  ImageF ramp(20, 10, 1);
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) ramp.at(x, y) = 0.02f * static_cast<float>(x) + 0.01f * static_cast<float>(y);
  }
  const ImageF gradient = luma_gradient(ramp);
  EXPECT_NEAR(gradient.at(10, 5, 0), 0.02f, 1e-6f);
  EXPECT_NEAR(gradient.at(10, 5, 1), 0.01f, 1e-6f);
}

}  // namespace
}  // namespace aligngs
