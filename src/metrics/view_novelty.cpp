#include "metrics/view_novelty.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angles.h"

namespace aligngs {

ViewNovelty view_novelty(const Camera& view, const std::vector<Camera>& training) {
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
