#include "edit/fill/hole_texture.h"

#include <gtest/gtest.h>

#include "edit/fill/grain_map.h"
#include "edit/fill/testing/parquet.h"
#include "edit/fill/testing/square_grid.h"

namespace aligngs {
namespace {

constexpr int kPlankSide = 200, kMatBegin = 60, kMatEnd = 140;
constexpr double kPlankCell = 0.02, kPlankExtent = 3;  // scene units

bool is_mat(int i, int j) { return i >= kMatBegin && i < kMatEnd && j >= kMatBegin && j < kMatEnd; }

std::vector<uint8_t> mat() {
  std::vector<uint8_t> cells;
  for (int k = 0; k < kPlankSide * kPlankSide; ++k) cells.push_back(is_mat(k % kPlankSide, k / kPlankSide));
  return cells;
}

/// The known cells of a parquet; shades are multiplied by `contrast`.
std::vector<KnownColor> planks(float contrast) {
  const TextureMap map = parquet::map(kPlankSide, is_mat);
  std::vector<KnownColor> known;
  for (int j = 0; j < kPlankSide; ++j) {
    for (int i = 0; i < kPlankSide; ++i) {
      if (map.knows(i, j)) known.push_back({{i + 0.5, j + 0.5}, map.value[map.index(i, j)] * contrast, 1, {}});
    }
  }
  return known;
}

TEST(HoleTexture, BoardsOfRandomShadesContinueInPhase) {
  const std::vector<Vec3f> texture =
      hole_texture(square_grid(kPlankSide, kPlankCell), mat(), planks(1), {kPlankExtent, true});
  ASSERT_FALSE(texture.empty());
  TextureMap inside{kPlankSide, kPlankSide, texture, {}};
  for (const uint8_t cell : mat()) inside.mask.push_back(cell ? 1.f : 0.f);
  const TextureMap grain = grain_map(inside, 3);
  int right = 0, all = 0;
  for (int j = kMatBegin + parquet::kSquare / 2; j < kMatEnd; j += parquet::kSquare) {
    for (int i = kMatBegin + parquet::kSquare / 2; i < kMatEnd; i += parquet::kSquare) {
      const float across = grain.value[grain.index(i, j)].x;
      right += (parquet::is_along_rows(i, j) ? across : -across) < 0;
      ++all;
    }
  }
  EXPECT_GE(right, all - 1) << "of " << all << " squares";
}

TEST(HoleTexture, AWallHasNoBoards) {
  const PlaneGrid wall = square_grid(kPlankSide, kPlankCell);
  EXPECT_TRUE(hole_texture(wall, mat(), planks(0.5f), {kPlankExtent, false}).empty());
}

TEST(HoleTexture, AnEvenSurfaceHasNone) {
  EXPECT_TRUE(hole_texture(square_grid(kPlankSide, kPlankCell), mat(), planks(0.001f), {kPlankExtent, true}).empty());
}

}  // namespace
}  // namespace aligngs
