#include "edit/fill/quilted_texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/random.h"

namespace aligngs {
namespace {

constexpr int kSide = 120, kBegin = 45, kEnd = 75;

bool is_hole(int i, int j) { return i >= kBegin && i < kEnd && j >= kBegin && j < kEnd; }

/// A known texture with a square hole; every third cell is unknown, as no Gaussian is in it.
TextureMap map_of(const std::function<float(int, int)>& shade) {
  TextureMap map{kSide, kSide, {}, {}};
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const float s = shade(i, j);
      map.value.push_back({s, s, 0.5f * s});
      map.mask.push_back(is_hole(i, j) || (i + j) % 3 == 0 ? 0.f : 1.f);
    }
  }
  return map;
}

std::vector<uint8_t> hole() {
  std::vector<uint8_t> cells;
  for (int k = 0; k < kSide * kSide; ++k) cells.push_back(is_hole(k % kSide, k / kSide));
  return cells;
}

/// Blotches of a few cells that repeat nowhere.
TextureMap blotches() {
  Random random(5);
  std::vector<Vec2d> places;
  for (int k = 0; k < 340; ++k) places.push_back({random.uniform(0, kSide), random.uniform(0, kSide)});
  return map_of([&](int i, int j) {
    double sum = -0.3;
    for (const Vec2d& p : places) sum += std::exp(-0.08 * ((i - p.x) * (i - p.x) + (j - p.y) * (j - p.y)));
    return static_cast<float>(sum);
  });
}

double contrast(const std::vector<Vec3f>& values, bool in_hole) {
  double sum = 0, squares = 0, count = 0;
  for (int k = 0; k < kSide * kSide; ++k) {
    if (is_hole(k % kSide, k / kSide) != in_hole) continue;
    const double v = static_cast<double>(values[static_cast<size_t>(k)].x);
    sum += v;
    squares += v * v;
    ++count;
  }
  return std::sqrt(squares / count - sum / count * (sum / count));
}

TEST(QuiltedTexture, TheHoleIsAsVariedAsTheSurface) {
  const TextureMap map = blotches();
  const std::vector<Vec3f> texture = quilted_texture(map, hole(), {});
  ASSERT_EQ(texture.size(), map.value.size());
  EXPECT_NEAR(contrast(texture, true), contrast(map.value, false), 0.35 * contrast(map.value, false));
}

TEST(QuiltedTexture, ItContinuesTheColoursAtTheRim) {
  const TextureMap map = blotches();
  const std::vector<Vec3f> texture = quilted_texture(map, hole(), {});
  double error = 0, other = 0;
  for (int j = kBegin; j < kEnd;
       ++j) {  // the first column of the hole against the one before, and against one far away
    const double inside = static_cast<double>(texture[map.index(kBegin, j)].x);
    error += std::fabs(inside - static_cast<double>(map.value[map.index(kBegin - 1, j)].x));
    other += std::fabs(inside - static_cast<double>(map.value[map.index(10, j)].x));
  }
  EXPECT_LT(error, 0.6 * other);
}

TEST(QuiltedTexture, PiecesFollowTheGuide) {
  const auto stripe = [](int i, int) { return i / 5 % 2 == 0 ? 0.3f : -0.3f; };
  const TextureMap map = map_of(stripe);
  const QuiltGuide guide{{}, map.value, true};
  const std::vector<Vec3f> texture = quilted_texture(map, hole(), &guide);
  for (int i = kBegin; i < kEnd; ++i) EXPECT_GT(texture[map.index(i, 60)].x * stripe(i, 60), 0) << i;
}

TEST(QuiltedTexture, PiecesMayFollowAnotherLookThanTheirColours) {
  const TextureMap map = map_of([](int i, int) { return i < 40 ? 0.3f : -0.3f; });
  QuiltGuide guide{{}, std::vector<Vec3f>(map.value.size(), Vec3f{9, 0, 0}), false};
  for (int k = 0; k < kSide * kSide; ++k) guide.looks.push_back({k % kSide < 40 ? 9.f : 0.f, 0, 0});
  EXPECT_LT(quilted_texture(map, hole(), nullptr)[map.index(60, 60)].x, 0);
  EXPECT_GT(quilted_texture(map, hole(), &guide)[map.index(60, 60)].x, 0);
}

TEST(QuiltedTexture, OnlyTheHoleGetsATexture) {
  const TextureMap map = blotches();
  const std::vector<Vec3f> texture = quilted_texture(map, hole(), {});
  EXPECT_EQ(norm(texture[map.index(kBegin - 1, 60)]), 0);
  EXPECT_EQ(norm(texture[map.index(kEnd, 60)]), 0);
}

TEST(QuiltedTexture, ASurfaceWithoutAWholePieceGivesNone) {
  QuiltSettings settings;
  settings.piece = 60;
  settings.overlap = 20;
  EXPECT_TRUE(quilted_texture(blotches(), hole(), {}, settings).empty());
}

}  // namespace
}  // namespace aligngs
