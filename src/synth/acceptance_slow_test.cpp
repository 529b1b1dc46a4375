// The simulated teachers err as real networks do: the default scenes stay inside the published ranges.
#include <gtest/gtest.h>

#include "synth/acceptance.h"

namespace aligngs {
namespace {

TEST(AcceptanceRanges, TheDefaultBedroomsAreInsideThem) {
  ThreadPool pool(2);
  std::vector<AcceptanceReport> reports;
  for (const uint64_t seed : {1, 2}) {
    SynthOptions options;
    options.seed = seed;
    options.degrade_images = options.shadows = false;  // teachers see geometry and labels, not the light
    options.samples_per_side = 1;
    options.segments = SegmentTeacher::kTeacher;
    reports.push_back(measure_acceptance(make_synth_scene(options, pool), pool));
    // A single scene may lie outside in a figure or two: the ranges are those of the mean over many rooms.
    int outside = 0;
    for (const AcceptanceFigure& f : reports.back().figures) outside += f.accepted() ? 0 : 1;
    EXPECT_LE(outside, 2) << "seed " << seed << "\n" << reports.back().table();
  }
  for (const AcceptanceFigure& f : mean_acceptance(reports).figures) {
    EXPECT_TRUE(f.accepted()) << f.name << " = " << f.value << " is outside " << f.low.value_or(0) << " to "
                              << f.high.value_or(0);
  }
}

}  // namespace
}  // namespace aligngs
