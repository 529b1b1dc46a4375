#include "refine/guided_match.h"

#include <gtest/gtest.h>

#include <cmath>

#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

const CornerSettings kCorners{150, 5, 0.01};  // strong ones of a photo of 160 x 120

/// The true place of pixel (x, y) of `from` in `to`.
Vec2d true_place(const RefineView& from, int x, int y, const Camera& to) {
  return to.project(to.world_to_camera * from.match.camera.unproject(x + 0.5, y + 0.5, from.match.depth.at(x, y)));
}

TEST(GuidedMatch, FindsThePlaceToAFractionOfAPixelThoughTheCameraIsWrong) {
  const RefineView from = photo(true_camera(0));
  RefineView to = photo(true_camera(2));
  Random random(3);
  to.match.camera = disturbed(to.match.camera, 1.0, 0.01, random);
  int found = 0, tried = 0;
  for (const Corner& c : find_corners(from.match.luma, {}, kCorners)) {
    const Vec2d want = true_place(from, c.x, c.y, true_camera(2));
    if (want.x < 20 || want.y < 20 || want.x > kWidth - 20 || want.y > kHeight - 20) continue;
    ++tried;
    const auto match = guided_match(from.match, c.x, c.y, to.match, {});
    if (!match) continue;
    ++found;
    EXPECT_LT(std::hypot(match->pixel.x - want.x, match->pixel.y - want.y), 0.5) << c.x << " " << c.y;
  }
  EXPECT_GT(found, tried / 3);
  EXPECT_GT(found, 10);
}

/// The photo from column `left` on, and the camera that took it.
MatchView right_part(const MatchView& photo, int left) {
  MatchView part;
  part.camera = photo.camera;
  part.camera.width -= left;
  part.camera.cx -= left;
  part.luma = ImageF(part.camera.width, photo.luma.height, 1);
  for (int y = 0; y < part.luma.height; ++y) {
    for (int x = 0; x < part.luma.width; ++x) part.luma.at(x, y) = photo.luma.at(x + left, y);
  }
  return part;
}

TEST(GuidedMatch, APlaceWhosePatchEndsAtThePhotosBorderMayLieBeyond) {
  const RefineView from = photo(true_camera(0));
  const MatchSettings settings;
  const int first = 80 - settings.half_patch;  // column of the patch around (80, 60)
  const auto inside = guided_match(from.match, 80, 60, right_part(from.match, first - 3), settings);
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->pixel.x, 80.5 - (first - 3), 0.1);
  EXPECT_FALSE(guided_match(from.match, 80, 60, right_part(from.match, first), settings));
}

TEST(GuidedMatch, AFlatPatchMatchesNothing) {
  RefineView from = photo(true_camera(0));
  const RefineView to = photo(true_camera(1));
  std::fill(from.match.luma.data.begin(), from.match.luma.data.end(), 0.7f);
  EXPECT_FALSE(guided_match(from.match, 80, 60, to.match, {}));
}

TEST(GuidedMatch, AnEdgeIsLessExactAlongItThanAcross) {
  RefineView from = photo(true_camera(0));
  from.match.depth = ImageF(kWidth, kHeight, 1, 3.0f);
  for (int y = 0; y < kHeight; ++y) {  // a horizontal edge, and a faint spot on it that makes it a place at all
    for (int x = 0; x < kWidth; ++x) {
      const double spot = 0.08 * std::exp(-0.08 * ((x - 80) * (x - 80) + (y - 60) * (y - 60)));
      from.match.luma.at(x, y) = static_cast<float>(0.5 + 0.3 * std::tanh(0.5 * (y - 60)) + spot);
    }
  }
  MatchSettings settings;
  settings.least_margin = 0;
  const auto match = guided_match(from.match, 80, 60, from.match, settings);
  ASSERT_TRUE(match);
  EXPECT_GT(match->covariance.xx, 10 * match->covariance.yy);
}

TEST(GuidedMatch, RepeatedTextureHasNoUniquePlace) {
  RefineView from = photo(true_camera(0));
  from.match.depth = ImageF(kWidth, kHeight, 1, 3.0f);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) from.match.luma.at(x, y) = (x / 3 + y / 3) % 2 ? 0.9f : 0.1f;
  }
  EXPECT_FALSE(guided_match(from.match, 80, 60, from.match, {}));
}

TEST(GuidedMatch, WithoutDepthOrAtTheBorderThereIsNothing) {
  RefineView from = photo(true_camera(0));
  EXPECT_FALSE(guided_match(from.match, 1, 60, from.match, {}));
  from.match.depth.at(80, 60) = 0;
  EXPECT_FALSE(guided_match(from.match, 80, 60, from.match, {}));
}

TEST(GuidedMatch, APatchAcrossADepthJumpShowsTwoSurfaces) {
  RefineView from = photo(true_camera(0));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 82; x < kWidth; ++x) from.match.depth.at(x, y) *= 2;
  }
  EXPECT_FALSE(guided_match(from.match, 80, 60, from.match, {}));
}

}  // namespace
}  // namespace aligngs
