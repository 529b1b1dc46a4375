#include "refine/bare_plane_factors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

/// Photos of the corner. A network put a square of the back wall a twentieth too near, and nothing measured it.
struct NearSquare {
  std::vector<MatchView> photos;
  std::vector<ImageF> certainty, truth;

  static bool inside(int x, int y) { return x >= 60 && x < 80 && y >= 40 && y < 60; }

  NearSquare() {
    for (int i = 0; i < 4; ++i) {
      photos.push_back(photo(true_camera(i), 0.3).match);
      truth.push_back(photos.back().depth);
      certainty.emplace_back(kWidth, kHeight, 1, 3.0f);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          if (!inside(x, y)) continue;
          photos.back().luma.at(x, y) = 0.9f;
          photos.back().depth.at(x, y) *= 0.95f;
          certainty.back().at(x, y) = 0;
        }
      }
    }
  }

  BarePlaneFactors factors() const {
    ThreadPool pool(2);
    return bare_plane_factors(photos, {}, certainty, bare_planes_of_network(), {}, {}, pool);
  }
};

TEST(BarePlaneFactors, BringTheDepthOntoThePlanes) {
  const NearSquare square;
  const BarePlaneFactors result = square.factors();
  EXPECT_FALSE(result.report.planes.empty());
  for (size_t i = 0; i < square.photos.size(); ++i)
    EXPECT_NEAR(
        square.photos[i].depth.at(70, 50) * std::exp(result.log_factors[i].at(70, 50)) / square.truth[i].at(70, 50), 1,
        0.005)
        << i;
}

TEST(BarePlaneFactors, APixelWithoutDepthHasNone) {
  NearSquare square;
  square.photos[1].depth.at(70, 50) = 0;
  EXPECT_EQ(square.factors().log_factors[1].at(70, 50), 0);
}

TEST(BarePlaneFactors, PhotosOfWhichNothingIsMeasuredKeepTheirDepth) {
  NearSquare square;
  for (ImageF& map : square.certainty) map = {};
  for (const ImageF& map : square.factors().log_factors) {
    for (const float factor : map.data) ASSERT_EQ(factor, 0);
  }
}

}  // namespace
}  // namespace aligngs
