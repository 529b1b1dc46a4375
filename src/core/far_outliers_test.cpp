#include "core/far_outliers.h"

#include <gmock/gmock.h>

namespace aligngs {
namespace {

std::vector<Vec3d> row(int count, double step) {
  std::vector<Vec3d> places;
  for (int i = 0; i < count; ++i) places.push_back({5e5 + step * i, 4e6, 0.1 * step * (i % 3)});
  return places;
}

TEST(FarOutliers, APlaceBeyondAllOthersIsOne) {
  std::vector<Vec3d> places = row(8, 0.3);
  places[3].y = -1e7;
  EXPECT_THAT(far_outliers(places), testing::ElementsAre(0, 0, 0, 1, 0, 0, 0, 0));
}

TEST(FarOutliers, DistantPlacesOfAScenePass) {
  std::vector<Vec3d> places = row(8, 0.3);
  places[3].y += 2000;  // sky
  EXPECT_THAT(far_outliers(places), testing::Each(false));
  places = row(8, 1e-9);  // a tripod
  places[3].y += 3;
  EXPECT_THAT(far_outliers(places), testing::Each(false));
}

TEST(FarOutliers, FewPlacesAndEqualOnesTellNothing) {
  std::vector<Vec3d> places = row(3, 0.3);
  places[1].y = 1e9;
  EXPECT_THAT(far_outliers(places), testing::Each(false));
  places = row(8, 0);
  places[3].y = 1e9;
  EXPECT_THAT(far_outliers(places), testing::Each(false));
}

}  // namespace
}  // namespace aligngs
