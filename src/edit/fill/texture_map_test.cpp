#include "edit/fill/texture_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "edit/fill/testing/square_grid.h"

namespace aligngs {
namespace {

/// 50 x 50 cells of 2 cm.
PlaneGrid floor_grid() { return square_grid(50, 0.02); }

/// `deviation`: of what it covers, in cells.
KnownColor gray(double x, double y, float shade, double deviation = 0) {
  const double variance = deviation * deviation;
  return {{x, y}, {shade, shade, shade}, 1, {variance, 0, variance}};
}

TEST(TextureMap, LightIsTakenAway) {
  std::vector<KnownColor> known;
  for (int j = 0; j < 50; ++j)
    for (int i = 0; i < 50; ++i)
      known.push_back(gray(i + 0.5, j + 0.5, 0.01f * static_cast<float>(i) + (i % 2 ? 0.2f : -0.2f)));
  TextureMapSettings settings;
  settings.light = 0.1;
  const TextureMap map = texture_map(floor_grid(), known, settings);
  EXPECT_NEAR(map.value[map.index(25, 25)].x, 0.2f, 0.03f);
  EXPECT_NEAR(map.value[map.index(24, 25)].x, -0.2f, 0.03f);
}

TEST(TextureMap, GaussiansMixAsTheyCover) {
  std::vector<KnownColor> known = {gray(25.5, 25.5, 0.f, 2), gray(25.5, 25.5, 1.f, 2), gray(5.5, 5.5, 0.5f)};
  TextureMapSettings settings;
  settings.spreads = 100;
  const TextureMap map = texture_map(floor_grid(), known, settings);
  EXPECT_TRUE(map.knows(27, 25)) << "a wide one covers its neighbours";
  EXPECT_TRUE(map.knows(5, 5));
  EXPECT_FALSE(map.knows(6, 5)) << "one without a spread covers its cell alone";
  EXPECT_NEAR(map.value[map.index(25, 25)].x, map.value[map.index(27, 25)].x, 0.02f) << "both show the mean";
}

TEST(TextureMap, ALongGaussianCoversALongStroke) {
  const KnownColor stroke{{25.5, 25.5}, {1, 1, 1}, 1, {5, 4.5, 5}};  // along the diagonal
  const TextureMap map = texture_map(floor_grid(), {stroke});
  EXPECT_TRUE(map.knows(29, 29));
  EXPECT_FALSE(map.knows(29, 21));
}

TEST(TextureMap, APlaceBeyondAllNumbersCoversNothing) {
  const double infinity = std::numeric_limits<double>::infinity();
  const TextureMap map =
      texture_map(floor_grid(), {gray(1e300, 5, 1), gray(-1e300, 5, 1, 2), gray(infinity, 5, 1), gray(NAN, 5, 1)});
  for (const float known : map.mask) EXPECT_EQ(known, 0);
}

TEST(TextureMap, AStainIsShortened) {
  std::vector<KnownColor> known;
  for (int j = 0; j < 50; ++j)
    for (int i = 0; i < 50; ++i) known.push_back(gray(i + 0.5, j + 0.5, (i + j) % 2 ? 0.1f : -0.1f));
  known[1275] = gray(25.5, 25.5, -5.f);
  const TextureMap map = texture_map(floor_grid(), known);
  EXPECT_LT(norm(map.value[map.index(25, 25)]), 3.01f * contrast_of(map));
}

TEST(TextureMap, NothingKnownHasNoContrast) {
  const TextureMap map = texture_map(floor_grid(), {});
  EXPECT_EQ(contrast_of(map), 0);
  EXPECT_FALSE(map.knows(3, 3));
  EXPECT_FALSE(map.knows(-1, 50));
}

}  // namespace
}  // namespace aligngs
