#include "scene/undistort.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "core/error.h"
#include "core/is_depth.h"

namespace aligngs {
namespace {

constexpr double kMinFocalScale = 0.5, kMaxFocalScale = 2;

/// Positive determinant of the distortion's Jacobian (by central differences) and a source inside of the image.
bool usable(const LensModel& lens, const Vec2d& p) {
  const Vec2d source = lens.project(p);
  if (!(source.x >= 0 && source.y >= 0 && source.x <= lens.width && source.y <= lens.height)) return false;
  constexpr double h = 1e-5;  // normalised image units; second-order error ~1e-10
  const Vec2d right = lens.distort({p.x + h, p.y}), left = lens.distort({p.x - h, p.y});
  const Vec2d down = lens.distort({p.x, p.y + h}), up = lens.distort({p.x, p.y - h});
  const double dxx = right.x - left.x, dyx = right.y - left.y, dxy = down.x - up.x, dyy = down.y - up.y;
  return dxx > 0 && dyy > 0 && dxx * dyy - dxy * dyx > 0;
}

/// Whether all pixels of the pinhole with focal lengths scaled by s have a source: tested on a grid that
/// includes the outermost pixel borders. The grid (33 x 33) is finer than any distortion polynomial of degree 6.
bool fully_covered(const LensModel& lens, double s) {
  constexpr int kSteps = 32;
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i <= kSteps; ++i) {
      const double u = static_cast<double>(lens.width) * i / kSteps, v = static_cast<double>(lens.height) * j / kSteps;
      if (!usable(lens, {(u - lens.cx) / (s * lens.fx), (v - lens.cy) / (s * lens.fy)})) return false;
    }
  }
  return true;
}

/// Calls body(x, y, source position in continuous pixels of the map) for each output pixel.
void for_each_source(int width, int height, const LensModel& lens, const Camera& pinhole, int out_width, int out_height,
                     const std::function<void(int, int, const Vec2d&)>& body) {
  const LensModel source = lens.resized(width, height);
  const Camera target = pinhole.resized(out_width, out_height);
  for (int y = 0; y < out_height; ++y) {
    for (int x = 0; x < out_width; ++x) {
      const Vec3d ray = target.ray(x + 0.5, y + 0.5);
      body(x, y, source.project({ray.x, ray.y}));
    }
  }
}

int target_height(int map_width, const Camera& pinhole) {
  return std::max(1, static_cast<int>(std::lround(static_cast<double>(map_width) * pinhole.height / pinhole.width)));
}

bool inside(const Vec2d& p, int width, int height) { return p.x >= 0 && p.y >= 0 && p.x <= width && p.y <= height; }

/// The four samples around a continuous position, clamped to the map, and the weight of the right and lower ones.
struct Corners {
  int x0, y0, x1, y1;
  float fx, fy;
  Corners(const Vec2d& p, int width, int height) {
    const double sx = std::clamp(p.x - 0.5, 0.0, width - 1.0), sy = std::clamp(p.y - 0.5, 0.0, height - 1.0);
    x0 = static_cast<int>(sx);
    y0 = static_cast<int>(sy);
    x1 = std::min(x0 + 1, width - 1);
    y1 = std::min(y0 + 1, height - 1);
    fx = static_cast<float>(sx - x0);
    fy = static_cast<float>(sy - y0);
  }
};

float blend(const ImageF& map, const Corners& k, int c) {
  const float top = map.at(k.x0, k.y0, c) * (1 - k.fx) + map.at(k.x1, k.y0, c) * k.fx;
  const float bottom = map.at(k.x0, k.y1, c) * (1 - k.fx) + map.at(k.x1, k.y1, c) * k.fx;
  return top * (1 - k.fy) + bottom * k.fy;
}

template <class T>
T nearest(const Image<T>& map, const Vec2d& p) {
  return map.at(std::clamp(static_cast<int>(p.x), 0, map.width - 1),
                std::clamp(static_cast<int>(p.y), 0, map.height - 1));
}

}  // namespace

Camera undistorted_camera(const LensModel& lens, const std::filesystem::path& path) {
  Camera camera = lens.pinhole();
  if (!lens.distorted()) return camera;
  if (!fully_covered(lens, kMaxFocalScale)) {
    throw_bad_input(path, "camera", "the distortion cannot be undone within the image: its parameters are too strong",
                    "calibrate the camera again, or undistort the images with the program that estimated it");
  }
  double low = kMinFocalScale, high = kMaxFocalScale;
  if (fully_covered(lens, low)) high = low;
  for (int i = 0; i < 40 && high > low; ++i) {  // 40 halvings of 1.5: far below a thousandth of a pixel
    const double middle = (low + high) / 2;
    (fully_covered(lens, middle) ? high : low) = middle;
  }
  camera.fx *= high;
  camera.fy *= high;
  return camera;
}

ImageF undistort_image(const ImageF& image, const LensModel& lens, const Camera& pinhole) {
  ImageF out(image.width, target_height(image.width, pinhole), image.channels);
  for_each_source(image.width, image.height, lens, pinhole, out.width, out.height, [&](int x, int y, const Vec2d& p) {
    if (!inside(p, image.width, image.height)) return;
    const Corners corners(p, image.width, image.height);
    for (int c = 0; c < image.channels; ++c) out.at(x, y, c) = blend(image, corners, c);
  });
  return out;
}

ImageF undistort_depth(const ImageF& depth, const LensModel& lens, const Camera& pinhole, float jump) {
  ImageF out(depth.width, target_height(depth.width, pinhole), 1);
  for_each_source(depth.width, depth.height, lens, pinhole, out.width, out.height, [&](int x, int y, const Vec2d& p) {
    if (!inside(p, depth.width, depth.height)) return;
    const float centre = nearest(depth, p);
    if (!is_depth(centre)) return;
    const Corners k(p, depth.width, depth.height);
    const float samples[4] = {depth.at(k.x0, k.y0), depth.at(k.x1, k.y0), depth.at(k.x0, k.y1), depth.at(k.x1, k.y1)};
    const bool smooth = std::all_of(samples, samples + 4,
                                    [&](float z) { return is_depth(z) && std::abs(z - centre) <= jump * centre; });
    out.at(x, y) = smooth ? blend(depth, k, 0) : centre;
  });
  return out;
}

Image<uint16_t> undistort_labels(const Image<uint16_t>& labels, const LensModel& lens, const Camera& pinhole,
                                 uint16_t none) {
  Image<uint16_t> out(labels.width, target_height(labels.width, pinhole), 1, none);
  for_each_source(labels.width, labels.height, lens, pinhole, out.width, out.height, [&](int x, int y, const Vec2d& p) {
    if (inside(p, labels.width, labels.height)) out.at(x, y) = nearest(labels, p);
  });
  return out;
}

}  // namespace aligngs
