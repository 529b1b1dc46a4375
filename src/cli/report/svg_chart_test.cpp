#include "cli/report/svg_chart.h"

#include <gmock/gmock.h>

#include <cmath>

namespace aligngs {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::Pointwise;

TEST(SvgChart, TicksAreRoundNumbersInsideTheRange) {
  EXPECT_THAT(round_ticks(0, 10, 5), ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(round_ticks(-0.3, 0.3, 3), ElementsAre(-0.2, 0, 0.2));
  EXPECT_TRUE(round_ticks(1, 1, 5).empty());
}

TEST(SvgChart, TicksOfALogarithmicAxisAreRoundValues) {
  std::vector<double> values;
  for (const double t : log_ticks(std::log10(0.015), std::log10(0.3), 5)) values.push_back(std::pow(10.0, t));
  EXPECT_THAT(values, Pointwise(DoubleNear(1e-12), {0.02, 0.05, 0.1, 0.2}));
}

TEST(SvgChart, ALogarithmicAxisOfManyDecadesHasFewerTicks) {
  EXPECT_THAT(log_ticks(-8, 0, 5), ElementsAre(-8, -7, -6, -5, -4, -3, -2, -1, 0));
}

TEST(SvgChart, ALogarithmicAxisOfLessThanADecadeHasTicksToo) {
  EXPECT_GE(log_ticks(std::log10(0.021), std::log10(0.045), 5).size(), 3u);
}

TEST(SvgChart, DrawsEachSeriesAndLeavesOutNonFinitePoints) {
  const std::string svg = svg_line_chart({"loss", "iteration", "", false}, {{"a<b", {{0, 1}, {1, NAN}, {2, 3}}}});
  EXPECT_THAT(svg, HasSubstr("<polyline"));
  EXPECT_THAT(svg, HasSubstr("a&lt;b"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(SvgChart, SaysWhenThereIsNothingToDraw) {
  ChartOptions options;
  options.log_y = true;
  EXPECT_THAT(svg_line_chart(options, {{"all below zero", {{0, -1}, {1, 0}}}}), HasSubstr("no data"));
}

TEST(SvgChart, AConstantSeriesIsDrawn) {
  EXPECT_THAT(svg_line_chart({}, {{"flat", {{0, 5}, {10, 5}}}}), HasSubstr("<polyline"));
}

}  // namespace
}  // namespace aligngs
