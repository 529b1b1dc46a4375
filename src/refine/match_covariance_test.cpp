#include "refine/match_covariance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

constexpr size_t kPixels = 121;  // a patch of 11 x 11

/// Scores 0.9 - (a x^2 + 2 b x y + d y^2) / 2 around the best place.
std::array<double, 9> quadratic(double a, double b, double d) {
  std::array<double, 9> scores{};
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x)
      scores[static_cast<size_t>(3 * (y + 1) + x + 1)] = 0.9 - 0.5 * (a * x * x + 2 * b * x * y + d * y * y);
  }
  return scores;
}

TEST(MatchCovariance, IsInverseToTheCurvature) {
  const MatchCovariance c = match_covariance(quadratic(0.2, 0.05, 0.1), kPixels);
  // covariance * curvature = noise * identity
  const double noise = c.xx * 0.2 + c.xy * 0.05;
  EXPECT_GT(noise, 0);
  EXPECT_NEAR(c.xx * 0.05 + c.xy * 0.1, 0, 1e-12);
  EXPECT_NEAR(c.xy * 0.2 + c.yy * 0.05, 0, 1e-12);
  EXPECT_NEAR(c.xy * 0.05 + c.yy * 0.1, noise, 1e-12);
}

TEST(MatchCovariance, AnEdgeIsPlacedAcrossItAlone) {
  const MatchCovariance c = match_covariance(quadratic(0, 0, 0.2), kPixels);  // a horizontal edge
  EXPECT_LT(std::sqrt(c.yy), 0.3);
  EXPECT_GT(std::sqrt(c.xx), 1);
  EXPECT_NEAR(c.xy, 0, 1e-12);
}

TEST(MatchCovariance, ABetterMatchIsMoreExact) {
  std::array<double, 9> worse = quadratic(0.2, 0, 0.2);
  for (double& score : worse) score -= 0.1;
  EXPECT_NEAR(match_covariance(worse, kPixels).xx, 2 * match_covariance(quadratic(0.2, 0, 0.2), kPixels).xx, 1e-12);
}

TEST(MatchCovariance, IsFiniteOnAPlateauAndAtAPerfectScore) {
  std::array<double, 9> plateau;
  plateau.fill(1);
  const MatchCovariance c = match_covariance(plateau, kPixels);
  // 2 (1 - s) / n H^-1 of two pixels' blobs, with the least misfit and curvature that count
  const double wanted = 2 * 2 * 0.01 / double(kPixels) / 1e-4;
  EXPECT_NEAR(c.xx, wanted, 1e-9);
  EXPECT_NEAR(c.yy, wanted, 1e-9);
  EXPECT_NEAR(c.xy, 0, 1e-9);
}

TEST(Whitening, MakesErrorsOfUnitCovariance) {
  const MatchCovariance c{0.5, 0.2, 0.3};
  const double deviation = 0.1;
  const auto w = whitening(c, deviation);
  const double xx = c.xx + deviation * deviation, yy = c.yy + deviation * deviation;
  // W C W' of (w0, 0; w1, w2)
  EXPECT_NEAR(w[0] * w[0] * xx, 1, 1e-12);
  EXPECT_NEAR(w[0] * (w[1] * xx + w[2] * c.xy), 0, 1e-12);
  EXPECT_NEAR(w[1] * w[1] * xx + 2 * w[1] * w[2] * c.xy + w[2] * w[2] * yy, 1, 1e-12);
}

TEST(Whitening, WithoutCovarianceDividesByTheDeviation) {
  const auto w = whitening({}, 0.25);
  EXPECT_NEAR(w[0], 4, 1e-12);
  EXPECT_NEAR(w[1], 0, 1e-12);
  EXPECT_NEAR(w[2], 4, 1e-12);
}

}  // namespace
}  // namespace aligngs
