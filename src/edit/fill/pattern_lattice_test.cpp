#include "edit/fill/pattern_lattice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "edit/fill/grain_map.h"
#include "edit/fill/testing/parquet.h"

namespace aligngs {
namespace {

constexpr int kFloorSide = 200, kRugBegin = 60, kRugEnd = 140;

bool is_rug(int i, int j) { return i >= kRugBegin && i < kRugEnd && j >= kRugBegin && j < kRugEnd; }

TextureMap floor_grain() { return grain_map(parquet::map(kFloorSide, is_rug), 3); }

/// Distance of a number from the nearest multiple of a period.
double from_multiple(double x, double period) { return std::fabs(x - period * std::round(x / period)); }

TEST(PatternLattice, AParquetLiesOnItselfAfterItsSquares) {
  const std::optional<PatternLattice> lattice = pattern_lattice(floor_grain());
  ASSERT_TRUE(lattice);
  for (const Vec2d& v : {lattice->first, lattice->second}) {
    EXPECT_LT(from_multiple(v.x + v.y, parquet::kPeriod), 2) << v.x << ", " << v.y;
    EXPECT_LT(from_multiple(v.x - v.y, parquet::kPeriod), 2) << v.x << ", " << v.y;
  }
}

TEST(PatternLattice, CopiesTellTheDirectionsUnderTheRug) {
  const TextureMap grain = floor_grain();
  const std::optional<PatternLattice> lattice = pattern_lattice(grain);
  ASSERT_TRUE(lattice);
  const std::vector<Vec3f> copies = mean_of_copies(grain, *lattice);
  for (int j = kRugBegin + parquet::kSquare / 2; j < kRugEnd; j += parquet::kSquare) {
    for (int i = kRugBegin + parquet::kSquare / 2; i < kRugEnd; i += parquet::kSquare) {
      const float across = copies[grain.index(i, j)].x;
      EXPECT_LT(parquet::is_along_rows(i, j) ? across : -across, 0) << i << ", " << j;
    }
  }
}

TEST(PatternLattice, NoiseHasNone) {
  Random random(8);
  TextureMap noise{kFloorSide, kFloorSide, {}, std::vector<float>(kFloorSide * kFloorSide, 1.f)};
  for (int k = 0; k < kFloorSide * kFloorSide; ++k)
    noise.value.push_back({static_cast<float>(random.uniform(-0.3, 0.3)), 0, 0});
  EXPECT_FALSE(pattern_lattice(grain_map(noise, 3)));
}

TEST(PatternLattice, NothingKnownHasNone) {
  EXPECT_FALSE(pattern_lattice({5, 5, std::vector<Vec3f>(25), std::vector<float>(25, 0.f)}));
}

}  // namespace
}  // namespace aligngs
