#include "nn/ops/resize.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "nn/testing/weights.h"

namespace aligngs::nn {
namespace {

TEST(Resize, BandsOfRowsAreThoseOfTheWhole) {
  ThreadPool pool(1);
  Compute compute(pool);
  FeatureMap map(7, 5, 3);
  map.data = random_values(map.data.size());
  for (const bool corners : {false, true}) {
    const ResampleAxis rows = bilinear_axis(7, 20, corners), columns = bilinear_axis(5, 11, corners);
    const FeatureMap whole = resample(compute, map, rows, columns);
    for (const int64_t begin : {0, 6, 13}) {
      const FeatureMap band = resample(compute, map, part_of_axis(rows, begin, 7), columns);
      ASSERT_EQ(band.height, 7);
      EXPECT_TRUE(std::equal(band.data.begin(), band.data.end(), whole.at(begin, 0)));
    }
  }
}

}  // namespace
}  // namespace aligngs::nn
