#include "edit/fill/repeated_texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/random.h"
#include "edit/fill/testing/square_grid.h"

namespace aligngs {
namespace {

constexpr int kCells = 80;
constexpr int kHoleBegin = 30, kHoleEnd = 50;
using Shade = std::function<float(double, double)>;

/// 80 x 80 cells of 2 cm.
PlaneGrid wall_grid() { return square_grid(kCells, 0.02); }

bool in_hole(int i, int j) { return i >= kHoleBegin && i < kHoleEnd && j >= kHoleBegin && j < kHoleEnd; }

/// Colours of all cells but those of a square hole.
std::vector<KnownColor> around_hole(const Shade& shade) {
  std::vector<KnownColor> known;
  for (int j = 0; j < kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      if (in_hole(i, j)) continue;
      const float s = shade(i + 0.5, j + 0.5);
      known.push_back({{i + 0.5, j + 0.5}, {s, 0.5f * s, -0.2f * s}, 1});
    }
  }
  return known;
}

/// Share of the pattern's variance in the hole that the texture explains; `pattern` has the mean 0.
double explained_in_hole(const std::vector<Vec3f>& texture, const Shade& pattern) {
  double error = 0, variance = 0;
  for (int j = kHoleBegin; j < kHoleEnd; ++j) {
    for (int i = kHoleBegin; i < kHoleEnd; ++i) {
      const double truth = static_cast<double>(pattern(i + 0.5, j + 0.5));
      const double found = static_cast<double>(texture[wall_grid().index(i, j)].x);
      error += (found - truth) * (found - truth);
      variance += truth * truth;
    }
  }
  return 1 - error / variance;
}

std::vector<Vec3f> texture_around(const std::vector<KnownColor>& known) {
  return repeated_texture(texture_map(wall_grid(), known));
}

float square_wave(double x, double period) { return x / period - std::floor(x / period) < 0.5 ? 0.3f : -0.3f; }

TEST(RepeatedTexture, StripesContinueInPhase) {
  const Shade stripes = [](double x, double) { return square_wave(x, 8); };
  const std::vector<Vec3f> texture = texture_around(around_hole(stripes));
  ASSERT_EQ(texture.size(), wall_grid().size());
  EXPECT_GT(explained_in_hole(texture, stripes), 0.9);
}

TEST(RepeatedTexture, APeriodNeedsNoWholeNumberOfCells) {
  const Shade tiles = [](double x, double y) { return 0.5f * (square_wave(x, 9.3) + square_wave(y, 11.7)); };
  EXPECT_GT(explained_in_hole(texture_around(around_hole(tiles)), tiles), 0.75);
}

TEST(RepeatedTexture, LightIsNoTexture) {
  const Shade stripes = [](double x, double) { return square_wave(x, 8); };
  const Shade lit = [&](double x, double y) { return stripes(x, y) + static_cast<float>(0.01 * (x + y)); };
  EXPECT_GT(explained_in_hole(texture_around(around_hole(lit)), stripes), 0.8);
}

TEST(RepeatedTexture, ThePatternKeepsItsColours) {
  const std::vector<Vec3f> texture = texture_around(around_hole([](double x, double) { return square_wave(x, 8); }));
  const Vec3f middle = texture[wall_grid().index(40, 40)];
  EXPECT_NEAR(middle.y, 0.5f * middle.x, 0.01f);
  EXPECT_NEAR(middle.z, -0.2f * middle.x, 0.01f);
}

TEST(RepeatedTexture, NoiseRepeatsNowhere) {
  Random random(7);
  EXPECT_TRUE(texture_around(around_hole([&](double, double) {
                return static_cast<float>(random.uniform(-0.3, 0.3));
              })).empty());
}

TEST(RepeatedTexture, BlotchesRepeatNowhere) {
  Random random(3);
  std::vector<Vec2d> places;
  for (int k = 0; k < 60; ++k) places.push_back({random.uniform(0, kCells), random.uniform(0, kCells)});
  EXPECT_TRUE(texture_around(around_hole([&](double x, double y) {
                float sum = 0;
                for (const Vec2d& p : places)
                  sum += static_cast<float>(std::exp(-0.1 * ((x - p.x) * (x - p.x) + (y - p.y) * (y - p.y))));
                return sum;
              })).empty());
}

TEST(RepeatedTexture, OneColourHasNone) {
  EXPECT_TRUE(texture_around(around_hole([](double, double) { return 0.4f; })).empty());
}

TEST(RepeatedTexture, AFewKnownCellsShowNone) {
  std::vector<KnownColor> known = around_hole([](double x, double) { return square_wave(x, 8); });
  known.resize(300);
  EXPECT_TRUE(texture_around(known).empty());
  EXPECT_TRUE(texture_around({}).empty());
}

}  // namespace
}  // namespace aligngs
