#include "edit/fill/grain_map.h"

#include <gtest/gtest.h>

#include "edit/fill/testing/parquet.h"

namespace aligngs {
namespace {

TEST(GrainMap, BoardsHaveTheirDirectionWhateverTheirShade) {
  const TextureMap grain = grain_map(parquet::map(120, [](int, int) { return false; }), 3);
  for (int j = parquet::kSquare / 2; j < 120; j += parquet::kSquare) {
    for (int i = parquet::kSquare / 2; i < 120; i += parquet::kSquare) {
      // Boards along the rows change along the columns: cos 2a is negative.
      const float across = grain.value[grain.index(i, j)].x;
      EXPECT_LT(parquet::is_along_rows(i, j) ? across : -across, 0) << i << ", " << j;
    }
  }
}

TEST(GrainMap, AnEvenSurfaceHasNone) {
  const TextureMap even{30, 30, std::vector<Vec3f>(900, Vec3f{0.2f, 0.2f, 0.2f}), std::vector<float>(900, 1.f)};
  for (const Vec3f& v : grain_map(even, 3).value) EXPECT_EQ(norm(v), 0);
}

TEST(GrainMap, NothingKnownHasNone) {
  const TextureMap nothing{30, 30, std::vector<Vec3f>(900), std::vector<float>(900, 0.f)};
  for (const Vec3f& v : grain_map(nothing, 3).value) EXPECT_EQ(norm(v), 0);
}

}  // namespace
}  // namespace aligngs
