#include "refine/depth_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.h"

namespace aligngs {
namespace {

/// A bent depth: too far at the left, too near at the right.
double bend(double x, double y) { return 0.06 * (0.5 - x) + 0.02 * y; }

std::vector<DepthGridSample> samples_of_bend(int count, double noise) {
  Random random(2);
  std::vector<DepthGridSample> samples;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(), y = random.uniform();
    samples.push_back({x, y, bend(x, y) + noise * random.normal()});
  }
  return samples;
}

TEST(DepthGrid, RemovesABend) {
  const DepthGrid grid = fit_depth_grid(samples_of_bend(300, 0.01));
  for (const double x : {0.1, 0.5, 0.9}) {
    for (const double y : {0.2, 0.8}) EXPECT_NEAR(grid.at(x, y), bend(x, y), 0.006);
  }
}

TEST(DepthGrid, AFifthOfOutliersMovesItLittle) {
  std::vector<DepthGridSample> samples = samples_of_bend(300, 0.01);
  for (size_t i = 0; i < samples.size(); i += 5) samples[i].log_ratio = 0.5;
  EXPECT_NEAR(fit_depth_grid(samples).at(0.5, 0.5), bend(0.5, 0.5), 0.02);
}

TEST(DepthGrid, FewSamplesChangeNothing) {
  const DepthGrid grid = fit_depth_grid(samples_of_bend(5, 0));
  EXPECT_EQ(grid.at(0.3, 0.3), 0);
}

TEST(DepthGrid, SamplesThatAreNoNumbersAreLeftOut) {
  std::vector<DepthGridSample> samples = samples_of_bend(100, 0);
  samples[3].log_ratio = std::numeric_limits<double>::quiet_NaN();
  const DepthGrid grid = fit_depth_grid(samples);
  samples.erase(samples.begin() + 3);
  const DepthGrid without = fit_depth_grid(samples);
  for (size_t i = 0; i < grid.log_factor.size(); ++i) EXPECT_NEAR(grid.log_factor[i], without.log_factor[i], 1e-12);
}

TEST(DepthGrid, AppliesToValidPixelsOnly) {
  DepthGrid grid;
  grid.log_factor.fill(std::log(2.0));
  ImageF depth(2, 1, 1);
  depth.data = {3, 0};
  grid.apply(depth);
  EXPECT_FLOAT_EQ(depth.data[0], 6);
  EXPECT_EQ(depth.data[1], 0);
}

}  // namespace
}  // namespace aligngs
