// place_near_origin of capture_frames.h. Positions are kept in float further on, which at a distance of d hold steps of
// d / 2^24.
#include <algorithm>
#include <cmath>
#include <string>

#include "core/log.h"
#include "scene/import/capture_frames.h"

namespace aligngs {
namespace {

/// Beyond this many extents from the origin, float steps reach a hundred thousandth of the extent.
constexpr double kFarFromOrigin = 100;
/// Extents, in arbitrary units, that need no scaling: a room in metres has about 5.
constexpr double kSmallExtent = 1e-2, kLargeExtent = 1e3;
/// Metres: cameras that spread over twice as much are no tour of rooms, but have positions in millimetres.
constexpr double kLargestRoom = 100;

/// The middle and half the diagonal of the box between the 5 % and 95 % quantiles, as in robust_extent().
struct Place {
  Vec3d middle;
  double extent = 0;
};

Place place_of(const Capture& capture) {
  std::vector<Vec3d> points;
  for (const CapturedFrame& frame : capture.frames) points.push_back(frame.world_to_camera.inverse().translation);
  points.insert(points.end(), capture.cloud.positions.begin(), capture.cloud.positions.end());
  Place place;
  double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vec3d& p : points) values.push_back(p[axis]);
    std::sort(values.begin(), values.end());
    const double low = values[static_cast<size_t>(0.05 * static_cast<double>(values.size() - 1))];
    const double high = values[static_cast<size_t>(0.95 * static_cast<double>(values.size() - 1))];
    place.middle[axis] = (low + high) / 2;
    squared += (high - low) * (high - low);
  }
  place.extent = std::sqrt(squared) / 2;
  return place;
}

}  // namespace

void place_near_origin(Capture& capture) {
  const Place place = place_of(capture);
  if (!(place.extent > 0) || !std::isfinite(place.extent)) return;  // one camera alone has no size
  const bool far = norm(place.middle) > kFarFromOrigin * place.extent;
  double scale = 1;
  if (capture.metric && place.extent > kLargestRoom) {
    capture.notes.push_back(fmt::format(
        "cameras spread over {:.3g} m: are their positions in millimetres? Depth is read in metres", 2 * place.extent));
  } else if (!capture.metric && (place.extent > kLargeExtent || place.extent < kSmallExtent)) {
    scale = std::pow(10.0, -std::floor(std::log10(place.extent)));  // the extent becomes 1 to 10
  }
  if (!far && scale == 1) return;
  // Whole numbers: what is moved by them comes back exactly.
  Vec3d shift;
  for (int k = 0; k < 3 && far; ++k) shift[k] = place.extent > 1 ? std::round(place.middle[k]) : place.middle[k];
  for (CapturedFrame& frame : capture.frames) {
    Rigidd to_world = frame.world_to_camera.inverse();
    to_world.translation = (to_world.translation - shift) * scale;
    frame.world_to_camera = to_world.inverse();
    frame.depth_scale *= scale;
  }
  for (Vec3d& p : capture.cloud.positions) p = (p - shift) * scale;
  Similarity back;
  back.scale = 1 / scale;
  back.translation = shift;
  capture.to_original = back;
  std::string done;
  if (far) done = fmt::format("moved by ({:.6g}, {:.6g}, {:.6g})", -shift.x, -shift.y, -shift.z);
  if (scale != 1) done += fmt::format("{}scaled by {:g}", far ? " and " : "", scale);
  capture.notes.push_back(fmt::format(
      "the world was {}; its cameras are at about ({:.6g}, {:.6g}, {:.6g}) and spread over {:.3g}; to_original in "
      "scene.json undoes it",
      done, place.middle.x, place.middle.y, place.middle.z, 2 * place.extent));
}

}  // namespace aligngs
