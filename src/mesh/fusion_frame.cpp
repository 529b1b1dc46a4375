#include "mesh/fusion_frame.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"

namespace aligngs {
namespace {

template <class T>
void check_map(const FusionFrame& frame, const Image<T>& map, int channels, const char* field, bool required) {
  if (map.empty() && !required) return;
  if (map.width == frame.camera.width && map.height == frame.camera.height && map.channels == channels) return;
  throw_bad_input(frame.name, field,
                  fmt::format("a map of {}x{}x{} does not fit a camera of {}x{} ({} channels expected)", map.width,
                              map.height, map.channels, frame.camera.width, frame.camera.height, channels),
                  "resize the map, or the camera with Camera::resized");
}

bool finite(const Rigidd& pose) {
  double sum = pose.translation.x + pose.translation.y + pose.translation.z;
  for (const double v : pose.rotation.m) sum += v;
  return std::isfinite(sum);
}

}  // namespace

void check_fusion_frames(const std::vector<FusionFrame>& frames) {
  for (const FusionFrame& frame : frames) {
    const Camera& c = frame.camera;
    if (c.width <= 0 || c.height <= 0 || !(c.fx > 0) || !(c.fy > 0) || !std::isfinite(c.cx + c.cy + c.fx + c.fy)) {
      throw_bad_input(frame.name, "camera", "the camera has no usable size or focal length");
    }
    if (!finite(c.world_to_camera)) throw_bad_input(frame.name, "pose", "the pose is not finite");
    check_map(frame, frame.depth, 1, "depth", true);
    check_map(frame, frame.color, 3, "color", false);
    check_map(frame, frame.normal, 3, "normal", false);
    check_map(frame, frame.alpha, 1, "alpha", false);
    check_map(frame, frame.label, 1, "label", false);
    check_map(frame, frame.label_probability, 1, "label_probability", false);
  }
}

}  // namespace aligngs
