#include "metrics/view_novelty.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aligngs {

ViewNovelty view_novelty(const Camera& view, const std::vector<Camera>& training) {
  constexpr double kDegreesPerRadian = 180 / 3.14159265358979323846;
  ViewNovelty out{std::numeric_limits<double>::infinity(), 180};
  for (const Camera& camera : training) {
    const Vec3d apart = view.centre() - camera.centre();
    const double cosine = std::clamp(dot(view.forward(), camera.forward()), -1.0, 1.0);
    out.distance = std::min(out.distance, std::sqrt(dot(apart, apart)));
    out.degrees = std::min(out.degrees, std::acos(cosine) * kDegreesPerRadian);
  }
  return out;
}

}  // namespace aligngs
