#include "edit/fill/near_cells.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.h"

namespace aligngs {
namespace {

TEST(NearCells, NeverDeniesAPointInReach) {
  Random random(5);
  const auto any = [&] { return static_cast<float>(10 * random.uniform() - 5); };
  std::vector<Vec3f> points;
  for (int k = 0; k < 40; ++k) points.push_back({any(), any(), any()});
  const NearCells cells(points, 0.8);
  for (int k = 0; k < 4000; ++k) {
    const Vec3f place{any(), any(), any()};
    const bool near =
        std::any_of(points.begin(), points.end(), [&](const Vec3f& p) { return norm(p - place) <= 0.8f; });
    EXPECT_TRUE(!near || cells.may_be_near(place));
  }
}

TEST(NearCells, FarPlacesAreDenied) {
  const NearCells cells({{0, 0, 0}}, 0.5);
  EXPECT_FALSE(cells.may_be_near({1.2f, 0, 0}));
  EXPECT_FALSE(NearCells({}, 0.5).may_be_near({0, 0, 0}));
}

}  // namespace
}  // namespace aligngs
