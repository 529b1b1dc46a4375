#include "refine/camera_report.h"

#include <gmock/gmock.h>

namespace aligngs {
namespace {

TEST(CameraReport, TellsTheFitBeforeAndAfter) {
  RefineResult result;
  result.tracks = 120;
  result.bundle.start_median = 2.262;
  result.bundle.end_median = 0.051;
  result.focal_factor = 1.0249;
  EXPECT_EQ(camera_report(result),
            "cameras refined from 120 tracks: reprojection error 2.26 px before, 0.05 px after, focal length x 1.025");
}

TEST(CameraReport, WithoutTracksNoErrorIsClaimed) {
  EXPECT_THAT(camera_report({}),
              testing::AllOf(testing::HasSubstr("the cameras stay"), testing::Not(testing::HasSubstr("px"))));
}

}  // namespace
}  // namespace aligngs
