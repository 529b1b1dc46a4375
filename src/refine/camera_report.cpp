#include "refine/camera_report.h"

#include <fmt/format.h>

namespace aligngs {

std::string camera_report(const RefineResult& result) {
  if (result.tracks == 0) {
    return "no point was found in two photos, so the cameras stay where they were; photos that overlap more can "
           "correct "
           "them";
  }
  return fmt::format(
      "cameras refined from {} tracks: reprojection error {:.2f} px before, {:.2f} px after, focal length x {:.3f}",
      result.tracks, result.bundle.start_median, result.bundle.end_median, result.focal_factor);
}

}  // namespace aligngs
